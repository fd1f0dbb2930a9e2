//! The `svs` command.

fn main() {}
