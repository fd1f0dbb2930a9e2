//! Help, wrong usage, exit code 2.

use crate::{folder, run};

const COMMANDS: [&str; 6] = ["build", "info", "validate", "verify", "sample", "strip"];

#[test]
fn help_of_every_command_has_examples() {
    let all = run(&["--help"]).ok();
    for command in COMMANDS.into_iter().chain(cfg!(feature = "render").then_some("render")) {
        assert!(all.stdout.contains(command), "{command} is not in {}", all.stdout);
        let help = run(&[command, "--help"]).ok().stdout;
        assert!(help.contains("Examples:") && help.contains(&format!("svs {command} ")), "{help}");
    }
}

#[test]
fn help_names_every_direction_set() {
    let help = run(&["build", "--help"]).ok().stdout;
    for name in svs_runtime::directions::DIRECTION_SETS {
        assert!(help.contains(name), "{name} is not in {help}");
    }
}

#[test]
fn version_is_told() {
    assert_eq!(run(&["--version"]).ok().stdout, format!("svs {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn wrong_usage_ends_with_code_2_and_says_what_is_right() {
    let cases: [(&[&str], &[&str]); 11] = [
        (&[], &["Usage"]),
        (&["bake"], &["bake"]),
        (&["build", "in.glb"], &["--output"]),
        (&["strip", "in.glb"], &["--output"]),
        (&["sample", "plant"], &["--output"]),
        (&["build", "in.glb", "-o", "out.obj"], &["out.obj", ".glb or .gltf"]),
        (
            &["build", "in.glb", "-o", "out.glb", "--directions", "isocahedron"],
            &["icosahedron-1", "dodecahedron"],
        ),
        (
            &["build", "in.glb", "-o", "out.glb", "--quality", "high", "--max-missing", "5"],
            &["cannot be used"],
        ),
        (&["build", "in.glb", "-o", "out.glb", "--prune", "1.5"], &["--prune", "0 to 1"]),
        (&["build", "in.glb", "-o", "out.glb", "--max-missing", "nan"], &["--max-missing", "above 0"]),
        (&["build", "in.glb", "-o", "out.glb", "--report", "out.glb"], &["--report", "another file"]),
    ];
    for (arguments, words) in cases {
        run(arguments).fails(2, words);
    }
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_work() {
    let folder = folder();
    let output = folder.path().join("nowhere/out.glb");
    let output = output.to_str().expect("UTF-8");
    run(&["build", "in.glb", "-o", output]).fails(1, &[output, "create it first"]);
    let is_folder = folder.path().join("x.glb");
    std::fs::create_dir(&is_folder).expect("a folder");
    run(&["sample", "boxes", "-o", is_folder.to_str().expect("UTF-8")]).fails(1, &["it is a folder"]);
}
