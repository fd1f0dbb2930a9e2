//! Every control, by script.

use crate::run::{Stand, distance, number, vector};
use serde_json::json;

#[test]
fn methods_quality_and_budgets_change_what_is_drawn() {
    let stand = Stand::new();
    let plant = stand.plant();
    stand.script(
        &plant,
        &json!([
            {"method": "nothing"}, {"dump": "nothing.json"},
            {"method": "frustum"}, {"dump": "frustum.json"},
            {"method": "visibility"}, {"dump": "visibility.json"}, "measure", {"dump": "measured.json"},
            {"quality": 0.1}, {"dump": "coarse.json"}, "measure", {"dump": "coarse-measured.json"},
            {"quality": 1}, {"dump": "fine.json"},
            {"quality": 0.5}, {"sphere_limit": 0}, {"dump": "no-spheres.json"},
            {"sphere_limit": 90}, {"triangle_budget": 5000}, {"dump": "budget.json"},
            {"frames": 12}, {"time_budget": 2}, {"frames": 6}, {"dump": "time.json"},
            "no_budget", {"method": "exact"}, {"dump": "exact.json"}, "measure", {"dump": "exact-measured.json"},
        ]),
    );
    let triangles = |name: &str| number(&stand.dump(name)["figures"]["triangles"]);
    let nothing = stand.dump("nothing.json");
    assert_eq!(nothing["figures"]["triangles"], nothing["total_triangles"]);
    assert_eq!(nothing["figures"]["objects"], nothing["objects"]);
    // The whole hall is in sight.
    assert_eq!(triangles("frustum.json"), triangles("nothing.json"));
    assert!(triangles("visibility.json") < 0.5 * triangles("frustum.json"));
    assert!(triangles("exact.json") <= triangles("fine.json"));
    assert!(triangles("coarse.json") < triangles("visibility.json"));
    assert!(triangles("fine.json") > triangles("visibility.json"));
    assert_eq!(triangles("no-spheres.json"), triangles("frustum.json"));
    assert!((1.0..=5000.0).contains(&triangles("budget.json")));
    // Left out for the budget, and therefore estimated to be missing.
    assert!(number(&stand.dump("budget.json")["figures"]["estimated_missing_ppm"]) > 0.0);
    assert!(triangles("time.json") <= triangles("visibility.json"));
    // Measurements: something is missing where much was left out, nothing with the exact method.
    assert!(number(&stand.dump("measured.json")["missing"]["ppm"]) < 20_000.0);
    let coarse = &stand.dump("coarse-measured.json")["missing"];
    assert!(number(&coarse["pixels"]) > 0.0 && number(&coarse["objects"]) > 0.0);
    assert_eq!(number(&stand.dump("exact-measured.json")["missing"]["pixels"]), 0.0);
    let figures = &stand.dump("visibility.json")["figures"];
    assert!(number(&figures["frame_ms"]) > 0.0 && number(&figures["cull_us"]) > 0.0);
    assert!(number(&figures["draws"]) >= 1.0 && figures["draws"].as_f64() <= figures["objects"].as_f64());
}

#[test]
fn frozen_culling_keeps_what_is_drawn_while_the_camera_flies_out() {
    let stand = Stand::new();
    let plant = stand.plant();
    stand.script(
        &plant,
        &json!([
            {"camera": "walk"}, {"look_from": {"eye": [5, 2, 10], "forward": [1, 0, -0.3]}}, {"dump": "before.json"},
            {"freeze": true}, {"camera": "orbit"}, {"key": "Home"}, {"drag": [180, 90]}, {"frames": 3},
            {"dump": "frozen.json"}, {"screenshot": "drawn.png"},
            {"skipped": true}, {"dump": "skipped.json"}, {"screenshot": "skipped.png"},
            {"skipped": false}, {"skipped_boxes": true}, {"screenshot": "boxes.png"}, {"skipped_boxes": false},
            {"method": "nothing"}, {"dump": "everything.json"},
            {"method": "visibility"}, {"freeze": false}, {"dump": "after.json"},
        ]),
    );
    let [before, frozen, skipped, everything, after] = ["before", "frozen", "skipped", "everything", "after"]
        .map(|name| stand.dump(&format!("{name}.json")));
    let eye = |dump: &serde_json::Value| vector(&dump["camera"]["eye"]);
    assert!(distance(eye(&before), eye(&frozen)) > 1.0);
    assert_eq!(before["drawn"], frozen["drawn"]);
    assert_ne!(before["drawn"], after["drawn"]);
    // What is skipped is drawn in addition, and shows.
    assert_eq!(skipped["drawn"], frozen["drawn"]);
    assert_eq!(skipped["figures"]["triangles"], frozen["figures"]["triangles"]);
    let red = |name: &str| stand.share(name, |[r, g, b]| r.saturating_sub(g.max(b)) > 50);
    assert!(red("skipped.png") > red("drawn.png") + 0.005, "{} {}", red("skipped.png"), red("drawn.png"));
    assert!(red("boxes.png") > red("drawn.png") + 0.001, "{} {}", red("boxes.png"), red("drawn.png"));
    // Settings still count, from the frozen camera.
    assert_eq!(everything["figures"]["objects"], everything["objects"]);
    assert!(number(&frozen["figures"]["objects"]) < number(&everything["objects"]));
}

#[test]
fn a_clicked_object_says_who_it_is_and_can_be_hidden() {
    let stand = Stand::new();
    // A row of boxes along x, the first at the origin: from -x only that one is seen.
    let boxes = stand.sample("boxes", "0.02");
    stand.script(
        &boxes,
        &json!([
            {"look_from": {"eye": [-6, 0.1, 0.1], "forward": [1, 0, 0]}}, {"frames": 2},
            {"click": [476, 400]}, {"dump": "picked.json"},
            {"hide": true}, {"dump": "hidden.json"}, {"click": [476, 400]}, {"dump": "behind.json"},
            {"key": "U"}, {"dump": "shown.json"},
            {"select": "box 3"}, {"key": "H"}, {"dump": "third.json"}, {"key": "h"}, {"dump": "third-shown.json"},
            {"look_from": {"eye": [-6, 0.1, 0.1], "forward": [-1, 0, 0]}}, {"dump": "away.json"},
            {"key": "F"}, {"dump": "framed.json"}, {"key": "Esc"}, {"dump": "unselected.json"},
            {"click": [3, 3]}, {"dump": "sky.json"},
        ]),
    );
    let picked = stand.dump("picked.json");
    assert_eq!(picked["viewport"], json!([952, 800]), "the click goes to the middle of the picture");
    assert_eq!(picked["picked"]["name"], "box 0");
    assert_eq!(picked["picked"]["triangles"], 12);
    assert!(picked["picked"]["why"].as_str().expect("a reason").starts_with("drawn: it is in the frustum"));
    let hidden = stand.dump("hidden.json");
    let object = &picked["picked"]["object"];
    let contains = |dump: &serde_json::Value| dump["drawn"].as_array().expect("a list").contains(object);
    assert!(contains(&picked) && !contains(&hidden));
    assert_eq!((&hidden["picked"]["hidden"], &hidden["picked"]["drawn"]), (&json!(true), &json!(false)));
    assert_eq!(hidden["hidden"], 1);
    assert_eq!(stand.dump("behind.json")["picked"]["name"], "box 1");
    let shown = stand.dump("shown.json");
    assert!(contains(&shown) && shown["hidden"] == 0);
    assert_eq!(stand.dump("third.json")["picked"]["hidden"], true);
    assert_eq!(stand.dump("third-shown.json")["picked"]["hidden"], false);
    let why = &stand.dump("away.json")["picked"]["why"];
    assert!(why.as_str().expect("a reason").contains("outside the frustum"), "{why}");
    let framed = stand.dump("framed.json");
    assert_eq!(framed["picked"]["drawn"], true);
    assert!(distance(vector(&framed["camera"]["eye"]), [6.0, 0.0, 0.0]) < 12.0);
    assert_eq!(stand.dump("unselected.json")["picked"], json!(null));
    assert_eq!(stand.dump("sky.json")["picked"], json!(null));
}

#[test]
fn baked_visibility_explains_what_is_skipped() {
    let stand = Stand::new();
    let plant = stand.plant();
    stand.script(
        &plant,
        &json!([{"frames": 2}, {"dump": "all.json"}, {"click": [476, 400]}, {"dump": "roof.json"},
                {"hide": true}, {"dump": "opened.json"}]),
    );
    let roof = stand.dump("roof.json");
    let why = roof["picked"]["why"].as_str().expect("a reason");
    assert!(why.starts_with("drawn: seen from outside") && why.contains("visible level"), "{why}");
    // A hole in the roof: the sphere of the hall is not trusted any more, more is drawn.
    let objects = |name: &str| number(&stand.dump(name)["figures"]["objects"]);
    assert!(objects("opened.json") > objects("all.json"));
}

#[test]
fn cameras_colours_spheres_graphs_and_keys_work() {
    let stand = Stand::new();
    let plant = stand.plant();
    stand.script(
        &plant,
        &json!([
            {"frames": 2}, {"dump": "start.json"}, {"screenshot": "material.png"},
            {"drag": [100, 0]}, {"dump": "turned.json"}, {"pan": [50, 20]}, {"dump": "panned.json"},
            {"wheel": 3}, {"dump": "near.json"}, {"key": "Home"}, {"dump": "home.json"},
            {"key": "Tab"}, {"dump": "walk.json"},
            {"hold": {"keys": ["w"], "seconds": 0.2}}, {"dump": "gone.json"},
            {"hold": {"keys": ["w", "shift"], "seconds": 0.2}}, {"dump": "gone-faster.json"},
            {"hold": {"keys": ["space"], "seconds": 0.2}}, {"dump": "risen.json"}, {"key": "1"}, {"key": "Home"},
            {"colours": "object"}, {"screenshot": "object.png"}, {"colours": "level"}, {"screenshot": "level.png"},
            {"colours": "importance"}, {"screenshot": "importance.png"}, {"key": "B"}, {"dump": "material.json"},
            {"spheres": true}, {"dump": "spheres.json"}, {"screenshot": "spheres.png"}, {"spheres": false},
            {"key": "G"}, {"frames": 2}, {"dump": "graphs.json"}, {"key": "F1"}, {"dump": "help.json"},
            {"screenshot": "help.png"}, {"key": "Esc"}, {"key": "F10"}, {"frames": 2}, {"dump": "closed.json"},
            {"key": "V"}, {"key": "]"}, {"key": "]"}, {"key": "["}, {"key": "X"}, {"key": "K"}, {"key": "J"}, {"key": "O"},
            {"key": "M"}, {"dump": "keys.json"}, {"continuous": true}, {"frames": 5}, {"dump": "continuous.json"},
        ]),
    );
    let dump = |name: &str| stand.dump(&format!("{name}.json"));
    let eye = |name: &str| vector(&dump(name)["camera"]["eye"]);
    assert!(distance(eye("turned"), eye("start")) > 0.1 && distance(eye("panned"), eye("turned")) > 0.1);
    assert!(distance(eye("near"), eye("panned")) > 0.1);
    assert!(distance(eye("home"), eye("turned")) < 1e-6, "framing the scene keeps the side");
    assert_eq!(dump("walk")["camera"]["mode"], "walk");
    assert!(distance(eye("walk"), eye("home")) < 1e-6);
    let step = distance(eye("gone"), eye("walk"));
    let expected = 0.2 * number(&dump("walk")["camera"]["metres_per_second"]);
    assert!((step / expected - 1.0).abs() < 0.15, "{step} m, expected {expected} m");
    assert!(distance(eye("gone-faster"), eye("gone")) > 4.0 * step);
    assert!(eye("risen")[1] > eye("gone-faster")[1]);
    let pictures =
        ["material", "object", "level", "importance"].map(|name| stand.picture(&format!("{name}.png")));
    for (index, a) in pictures.iter().enumerate() {
        for b in &pictures[index + 1..] {
            assert!(stand.differing(a, b) > 0.001, "two colour modes look alike");
        }
    }
    assert_eq!(dump("material")["state"]["colours"], "material");
    assert!(number(&dump("spheres")["spheres"]) >= 1.0);
    let blue = |name: &str| stand.share(name, |[r, g, b]| b > 230 && g > 170 && r < 120);
    assert!(blue("spheres.png") > blue("material.png"));
    // Graphs and panel take their room from the picture of the scene.
    assert_eq!(dump("start")["viewport"], json!([952, 800]));
    assert!(number(&dump("graphs")["viewport"][1]) < 700.0);
    assert_eq!(dump("closed")["viewport"][0], 1280);
    assert_eq!(
        (&dump("help")["state"]["help"], &dump("closed")["state"]["help"]),
        (&json!(true), &json!(false))
    );
    let keys = dump("keys");
    assert_eq!(keys["state"]["method"], "exact");
    assert!((number(&keys["state"]["quality"]) - 0.55).abs() < 1e-5);
    for on in ["freeze", "skipped", "skipped_boxes", "spheres"] {
        assert_eq!(keys["state"][on], true, "{on}");
    }
    assert_eq!(keys["missing"]["pixels"], 0);
    let frames = |name: &str| number(&dump(name)["frames"]);
    assert!(frames("continuous") >= frames("keys") + 5.0);
}

#[test]
fn nothing_is_drawn_anew_while_nothing_changes() {
    let stand = Stand::new();
    let boxes = stand.sample("boxes", "0.02");
    stand.script(
        &boxes,
        &json!([{"frames": 3}, {"dump": "before.json"}, {"frames": 10}, {"dump": "after.json"}]),
    );
    assert_eq!(stand.dump("before.json")["frames"], stand.dump("after.json")["frames"]);
}
