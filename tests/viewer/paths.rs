//! Camera paths and camera files.

use crate::run::{Stand, distance, number, vector};
use serde_json::json;
use svs::camera_path::CameraPath;

#[test]
fn a_recorded_path_is_written_played_and_used_as_camera() {
    let stand = Stand::new();
    let boxes = stand.sample("boxes", "0.02");
    stand.script(
        &boxes,
        &json!([
            {"path_file": "flight.json"}, {"camera": "walk"},
            {"look_from": {"eye": [-6, 1, 3], "forward": [1, -0.1, -0.2]}}, {"dump": "start.json"},
            {"record": true}, {"hold": {"keys": ["w"], "seconds": 1}}, {"drag": [60, 0]},
            {"hold": {"keys": ["d"], "seconds": 1}}, {"dump": "recording.json"}, {"record": false}, {"dump": "end.json"},
            {"key": "Home"}, {"play": true}, {"dump": "playing.json"}, "wait_for_play", {"dump": "played.json"},
            {"path_file": "nowhere.json"}, {"play": true}, {"dump": "no-path.json"},
        ]),
    );
    let path = CameraPath::read(&stand.path("flight.json")).expect("the path file");
    assert!(path.poses.len() > 10, "{} poses", path.poses.len());
    let eye = |name: &str| vector(&stand.dump(name)["camera"]["eye"]);
    assert!(stand.dump("recording.json")["tape"].as_str().expect("a text").starts_with("recording"));
    assert!(stand.dump("end.json")["message"]["text"].as_str().expect("a text").contains("flight.json"));
    let first = path.poses[0].eye.to_array();
    assert!(distance(first, eye("start.json")) < 0.3, "{first:?} {:?}", eye("start.json"));
    assert!(distance(eye("playing.json"), first) < 0.2);
    assert!(distance(eye("played.json"), eye("end.json")) < 1e-3);
    assert_eq!(stand.dump("no-path.json")["message"]["error"], true);

    // The same file is a camera.
    let script = stand.path("look.json");
    std::fs::write(&script, r#"[{"dump": "look.json.out"}]"#).expect("a script");
    let child = stand
        .viewer(&boxes)
        .args(["--quality", "0.7", "--method", "frustum", "--size", "640x480"])
        .arg("--camera")
        .arg(stand.path("flight.json"))
        .arg("--script")
        .arg(script)
        .spawn()
        .expect("svs starts");
    let output = crate::run::finish(child);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let look = stand.dump("look.json.out");
    assert!(distance(vector(&look["camera"]["eye"]), first) < 1e-6);
    assert_eq!(look["state"]["method"], "frustum");
    assert!((number(&look["state"]["quality"]) - 0.7).abs() < 1e-6);
    assert_eq!(look["viewport"], json!([640 - 328, 480]));
}
