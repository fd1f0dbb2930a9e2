//! `cargo xtask samples`: the sample asset of the specification, written anew.

use crate::run;

pub(crate) fn samples() -> Result<(), String> {
    run::step(
        "samples",
        run::cargo()
            .args(["test", "--release", "--package", "svs", "--test", "samples"])
            .env("SVS_WRITE_SAMPLES", "1"),
    )
}
