//! `svs sample grid`.

use crate::{folder, run, small_scene};

#[test]
fn a_grid_repeats_a_scene_and_can_be_baked() {
    let folder = folder();
    let scene = small_scene(&folder, "scene.glb");
    let output = folder.path().join("grid.glb");
    let [scene, output] = [&scene, &output].map(|path| path.to_str().expect("UTF-8"));
    let made = run(&["sample", "grid", "--of", scene, "--copies", "9", "-o", output, "--json"]).ok().json();
    assert_eq!((&made["kind"], &made["copies"]), (&"grid".into(), &9.into()));
    let objects = made["objects"].as_u64().expect("a number");
    assert!(objects >= 9 && objects.is_multiple_of(9), "{made}");
    let report = folder.path().join("report.json");
    let report = report.to_str().expect("UTF-8");
    run(&["build", output, "-o", output, "--quality", "draft", "--rays", "100000", "-q", "--report", report])
        .ok();
    // What was baked is of the whole grid, and goes when it is repeated again.
    let again =
        run(&["sample", "grid", "--of", output, "--copies", "2", "--spacing", "2", "-o", output]).ok();
    assert!(again.stdout.contains("baked visibility is taken out"), "{again:?}");
}

#[test]
fn wrong_usage_of_a_grid_is_explained() {
    let folder = folder();
    let scene = small_scene(&folder, "scene.glb");
    let scene = scene.to_str().expect("UTF-8");
    let cases: [(&[&str], &[&str]); 6] = [
        (&["grid"], &["--of"]),
        (&["grid", "--of", scene, "--scale", "2"], &["--copies"]),
        (&["grid", "--of", scene, "--copies", "0"], &["--copies 0"]),
        (&["grid", "--of", scene, "--spacing", "0"], &["--spacing"]),
        (&["plant", "--of", scene], &["grid"]),
        (&["plant", "--copies", "3"], &["--of"]),
    ];
    for (arguments, words) in cases {
        run(&[&["sample"], arguments, &["-o", "out.glb"]].concat()).fails(2, words);
    }
    run(&["sample", "grid", "--of", "missing.glb", "-o", "out.glb"]).fails(1, &["missing.glb"]);
}
