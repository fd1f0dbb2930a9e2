//! Developer commands: `cargo xtask test`, `cargo xtask bench scenes`.

fn main() {}
