//! What the fuzz targets do, what they start from, and how their input is changed. Shared by the libFuzzer targets in
//! `fuzz_targets/` and by `tests/fuzz_smoke.rs`, which needs no nightly compiler.
#![allow(dead_code, reason = "each program uses a part of this")]

pub(crate) mod input;
pub(crate) mod mutate;
pub(crate) mod seeds;
pub(crate) mod smoke;
#[cfg(feature = "render")]
pub(crate) mod stage;
pub(crate) mod targets;
