//! `cargo xtask test`: everything that must hold before a change is taken.

use crate::{khronos, run, system, web};

pub(crate) fn test() -> Result<(), String> {
    for (tool, component) in [("fmt", "rustfmt"), ("clippy", "clippy")] {
        if !run::succeeds(run::cargo().args([tool, "--version"])) {
            let mut rustup = std::process::Command::new("rustup");
            run::step(&format!("install {component}"), rustup.args(["component", "add", component]))?;
        }
    }
    run::step("formatting", run::cargo().args(["fmt", "--all", "--check"]))
        .map_err(|error| format!("{error}; `cargo fmt --all` repairs it"))?;
    run::step(
        "lints",
        run::cargo().args(["clippy", "--release", "--workspace", "--all-targets", "--", "-D", "warnings"]),
    )?;
    run::step(
        "lints without the renderer",
        run::cargo().args([
            "clippy",
            "--release",
            "-p",
            "svs",
            "--no-default-features",
            "--features=bake",
            "--",
            "-D",
            "warnings",
        ]),
    )?;
    khronos::install()?;
    system::install()?;
    web::test()?;
    // Last, so that the output ends with the test runners' own summaries. The Khronos validator runs in here.
    let mut tests = run::cargo();
    tests.args(["test", "--release", "--workspace"]).env("SVS_REQUIRE_KHRONOS", "1");
    // The same cases every time here; `cargo test` by itself tries new ones.
    if std::env::var_os("PROPTEST_RNG_SEED").is_none() {
        tests.env("PROPTEST_RNG_SEED", "20130401");
    }
    run::step("tests", &mut tests)
}
