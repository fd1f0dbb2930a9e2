//! `svs render`: pictures, and what is said where there are none.

use crate::{Finished, build, folder, handmade, plant, run, svs};
use serde_json::json;
use std::fs;
use std::path::Path;

/// Draws at 320 x 180 and reads the picture back.
fn render(file: &Path, output: &Path, more: &[&str]) -> (Finished, image::RgbImage) {
    let mut command = svs();
    command.arg("render").arg(file).arg("-o").arg(output).args(["--size", "320x180", "--json"]).args(more);
    let finished = Finished::from(command.output().expect("svs starts")).ok();
    let picture = image::open(output).expect("a picture").into_rgb8();
    assert_eq!(picture.dimensions(), (320, 180));
    (finished, picture)
}

/// Share of pixels that differ visibly.
fn difference(a: &image::RgbImage, b: &image::RgbImage) -> f64 {
    let differs = |(a, b): &(&image::Rgb<u8>, &image::Rgb<u8>)| (0..3).any(|c| a.0[c].abs_diff(b.0[c]) > 4);
    a.pixels().zip(b.pixels()).filter(differs).count() as f64 / a.pixels().len() as f64
}

fn colours(picture: &image::RgbImage) -> usize {
    picture.pixels().map(|pixel| pixel.0).collect::<std::collections::BTreeSet<_>>().len()
}

#[test]
fn pictures_of_the_plant() {
    pictures_of(&plant());
}

#[test]
fn pictures_of_an_apartment_made_by_others() {
    let scenes = std::env::var_os("SVS_SCENES")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes"), Into::into);
    let folder = scenes.join("duplex-apartment");
    let files = fs::read_dir(&folder).into_iter().flatten().flatten().map(|entry| entry.path());
    match files.filter(|file| file.extension().is_some_and(|e| e == "glb" || e == "gltf")).min() {
        Some(scene) => pictures_of(&scene),
        None => eprintln!("SKIPPED: there is no scene in {}", folder.display()),
    }
}

/// From outside and inside: what each method leaves out is not missed, and it is much.
fn pictures_of(scene: &Path) {
    let folder = folder();
    let baked = folder.path().join("baked.glb");
    build(scene, &baked, &["-q"]).ok();
    let output = folder.path().join("out.png");
    for camera in ["outside", "inside"] {
        let of = |method: &str| {
            let more = ["--camera", camera, "--frame", "3", "--frames", "9", "--method", method];
            let (finished, picture) = render(&baked, &output, &more);
            (finished.json(), picture)
        };
        let (nothing, all) = of("nothing");
        assert!(colours(&all) > 100, "{camera}: {} colours", colours(&all));
        assert_eq!((&nothing["baked"], &nothing["objects"]), (&json!(true), &nothing["scene_objects"]));
        assert_eq!(nothing["notice"], json!(null));
        let mut triangles = nothing["triangles"].as_u64().expect("a number");
        assert!(nothing["draw_calls"].as_u64() > Some(0) && nothing["frame_ms"].as_f64() > Some(0.0));
        // Of what is left out, nothing or next to nothing is seen: this bake was a quick one.
        for (method, most) in [("frustum", 0.0), ("visibility", 0.01), ("exact", 0.001)] {
            let (drawn, picture) = of(method);
            let difference = difference(&all, &picture);
            assert!(difference <= most, "{camera}, {method}: {difference}");
            let fewer = drawn["triangles"].as_u64().expect("a number");
            assert!(fewer <= triangles && fewer > 0, "{camera}, {method}: {fewer} of {triangles}");
            triangles = fewer;
        }
        assert!(2 * triangles < nothing["triangles"].as_u64().unwrap_or(0), "{camera}: {triangles}");
    }
}

#[test]
fn colours_items_budgets_and_files_without_a_bake() {
    let folder = folder();
    let output = folder.path().join("out.png");
    let inside = ["--camera", "inside", "--frame", "40"];
    let (plain, picture) = render(&plant(), &output, &inside);
    assert_eq!(plain.json()["baked"], json!(false));
    for more in [&["--colour", "object"][..], &["--items"]] {
        let (_, other) = render(&plant(), &output, &[&inside[..], more].concat());
        assert!(difference(&picture, &other) > 0.5, "{more:?}");
    }
    let (drawn, _) = render(&plant(), &output, &[&inside[..], &["--budget", "20000"]].concat());
    let drawn = drawn.json();
    assert!((1..=20_000).contains(&drawn["triangles"].as_u64().expect("a number")), "{drawn}");
    // For people, the same in words.
    let words = run(&["render".as_ref(), plant().as_os_str(), "-o".as_ref(), output.as_os_str()]).ok().stdout;
    assert!(words.contains("4,433 of 4,433") && words.contains("draw calls"), "{words}");
}

#[test]
fn proxies_are_drawn_where_the_file_has_them() {
    let folder = folder();
    let (scene, output) = (folder.path().join("balls.glb"), folder.path().join("out.png"));
    handmade::document().write(&scene).expect("a file");
    let of = |more: &[&str]| {
        let (finished, picture) = render(&scene, &output, more);
        (finished.json(), picture)
    };
    let (off, all) = of(&["--proxies", "off"]);
    assert_eq!((&off["proxies"], &off["simplified_objects"]), (&json!(0), &json!(0)));
    let (coarse, picture) = of(&["--detail", "500", "--metric", "sse"]);
    assert!(coarse["proxies"].as_u64() > Some(0), "{coarse}");
    assert!(coarse["triangles"].as_u64() < off["triangles"].as_u64(), "{coarse} {off}");
    let off_by = difference(&all, &picture);
    assert!(off_by > 0.0 && off_by < 0.3, "{off_by}");
    let (fine, same) = of(&["--detail", "0"]);
    assert_eq!((&fine["proxies"], difference(&all, &same)), (&json!(0), 0.0));
    let (budget, _) = of(&["--budget", "3000"]);
    assert!(budget["triangles"].as_u64() <= Some(3000), "{budget}");
    for colour in ["proxies", "severity"] {
        let (_, tinted) = of(&["--detail", "500", "--metric", "sse", "--colour", colour]);
        assert!(difference(&picture, &tinted) > 0.005, "{colour}");
    }
}

#[test]
fn cameras_come_from_files() {
    let folder = folder();
    let (camera, output) = (folder.path().join("camera.json"), folder.path().join("out.png"));
    let draw = |text: &str| {
        fs::write(&camera, text).expect("a camera file");
        let arguments =
            ["render".into(), plant().into_os_string(), "--camera".into(), camera.clone().into_os_string()];
        let more = ["-o".into(), output.clone().into_os_string(), "--size".into(), "64x36".into()];
        run(&[&arguments[..], &more].concat())
    };
    draw(r#"{"version": 1, "poses": [{"eye": [5, 2, 5], "forward": [1, 0, 1]}]}"#).ok();
    assert!(output.is_file());
    let cases = [
        (r#"{"version": 1, "poses": []}"#, "/poses"),
        (r#"{"version": 1, "poses": [{"eye": [5, 2], "forward": [1, 0, 1]}]}"#, "/poses/0/eye"),
        ("{", "JSON"),
    ];
    for (text, word) in cases {
        draw(text).fails(1, &["camera.json", word]);
    }
    fs::remove_file(&camera).expect("removed");
    let arguments =
        ["render", plant().to_str().expect("UTF-8"), "-o", "x.png", "--camera"].map(str::to_owned);
    let missing = camera.display().to_string();
    run(&[&arguments[..], std::slice::from_ref(&missing)].concat()).fails(1, &[&missing]);
}

#[test]
fn wrong_usage_is_explained() {
    let plant = plant();
    let plant = plant.to_str().expect("UTF-8");
    let cases: [(&[&str], &[&str]); 10] = [
        (&[], &["--output"]),
        (&["-o", "out.jpg"], &["out.jpg", ".png"]),
        (&["-o", "out.png", "--size", "1280"], &["--size", "1280x720"]),
        (&["-o", "out.png", "--size", "0x720"], &["--size"]),
        (&["-o", "out.png", "--size", "99999x720"], &["--size", "16384"]),
        (&["-o", "out.png", "--method", "all"], &["nothing", "frustum", "visibility", "exact"]),
        (&["-o", "out.png", "--quality", "2"], &["--quality", "0 to 1"]),
        (&["-o", "out.png", "--max-angle", "100"], &["--max-angle", "90"]),
        (&["-o", "out.png", "--frame", "7", "--frames", "7"], &["--frame 7", "0 to 6"]),
        (&["-o", "out.png", "--items", "--colour", "level"], &["cannot be used"]),
    ];
    for (arguments, words) in cases {
        run(&[&["render", plant], arguments].concat()).fails(2, words);
    }
}

#[test]
fn what_cannot_be_read_or_written_ends_with_code_1() {
    let folder = folder();
    let lost = folder.path().join("nowhere/out.png");
    let lost = lost.to_str().expect("UTF-8");
    run(&["render", "in.glb", "-o", lost]).fails(1, &[lost, "create it first"]);
    let output = folder.path().join("out.png");
    let whole = fs::read(plant()).expect("the sample");
    let broken: [(&str, &[u8]); 3] = [
        ("text.glb", b"no scene"),
        ("cut.glb", &whole[..whole.len() / 2]),
        (
            "cycle.gltf",
            br#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"children": [0]}]}"#,
        ),
    ];
    for (name, bytes) in broken {
        let file = folder.path().join(name);
        fs::write(&file, bytes).expect("the file is written");
        run(&["render".as_ref(), file.as_os_str(), "-o".as_ref(), output.as_os_str()]).fails(1, &[name]);
        assert!(!output.exists());
    }
}
