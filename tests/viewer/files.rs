//! Opening files: dropped ones, broken ones, ones without baked visibility.

use crate::run::Stand;
use serde_json::json;

#[test]
fn a_dropped_file_is_opened_and_a_broken_one_keeps_the_scene() {
    let stand = Stand::new();
    let plant = stand.plant();
    let boxes = stand.sample("boxes", "0.02");
    std::fs::write(stand.path("broken.glb"), b"glTF but not really").expect("a file");
    stand.script(
        &plant,
        &json!([
            {"dump": "plant.json"}, {"click": [476, 400]}, {"freeze": true},
            {"drop": "broken.glb"}, {"frames": 2}, {"dump": "broken.json"}, {"screenshot": "broken.png"},
            {"drop": boxes}, {"frames": 2}, {"dump": "boxes.json"},
            {"drop": "missing.glb"}, {"frames": 2}, {"dump": "missing.json"},
        ]),
    );
    let [plant, broken, boxes, missing] =
        ["plant", "broken", "boxes", "missing"].map(|name| stand.dump(&format!("{name}.json")));
    assert_eq!((&plant["file"], &plant["baked"]), (&json!("plant.svs.glb"), &json!(true)));
    assert_eq!(plant["message"], json!(null));
    assert_eq!(broken["file"], "plant.svs.glb");
    assert_eq!(broken["drawn"], plant["drawn"]);
    assert_eq!(broken["message"]["error"], true);
    let text = broken["message"]["text"].as_str().expect("a text");
    assert!(text.contains("broken.glb"), "{text}");
    assert_eq!((&boxes["file"], &boxes["baked"]), (&json!("boxes.glb"), &json!(false)));
    assert_eq!((&boxes["objects"], &boxes["picked"]), (&json!(10), &json!(null)));
    assert_eq!(boxes["state"]["freeze"], false);
    let notice = boxes["message"]["text"].as_str().expect("a notice");
    assert!(notice.contains("frustum") && boxes["message"]["error"] == false, "{notice}");
    assert!(number_of(&boxes["drawn"]) > 0);
    assert_eq!(missing["file"], "boxes.glb");
    assert_eq!(missing["message"]["error"], true);
}

fn number_of(list: &serde_json::Value) -> usize {
    list.as_array().map_or(0, Vec::len)
}

#[test]
fn a_broken_file_opens_a_window_that_says_so() {
    let stand = Stand::new();
    let broken = stand.path("broken.glb");
    std::fs::write(&broken, [0; 100]).expect("a file");
    stand.script(&broken, &json!([{"frames": 2}, {"dump": "state.json"}, {"click": [100, 100]}, "measure"]));
    let state = stand.dump("state.json");
    assert_eq!((&state["file"], &state["message"]["error"]), (&json!(null), &json!(true)));
}

#[test]
fn what_cannot_work_is_said_without_a_window() {
    let stand = Stand::new();
    let output = stand.viewer(&stand.path("nothing.glb")).output().expect("svs starts");
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(text.contains("nothing.glb"), "{text}");

    let boxes = stand.sample("boxes", "0.02");
    let output = stand.viewer(&boxes).env("DISPLAY", ":4711").output().expect("svs starts");
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("svs render") && !text.contains("panicked"), "{text}");

    let output = stand.try_script(&boxes, &json!([{"method": "magic"}]));
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("step 1") && text.contains("magic"), "{text}");
}
