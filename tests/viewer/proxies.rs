//! The controls of proxies, by script and by mouse.

use crate::handmade::{self, SIDE};
use crate::run::{Open, Stand, number};
use serde_json::{Value, json};
use std::path::PathBuf;

fn balls(stand: &Stand) -> PathBuf {
    let path = stand.path("balls.glb");
    handmade::document().write(&path).expect("a file");
    path
}

/// A camera step: the whole scene, from some radii away.
fn from(radii: f64) -> Value {
    let eye = handmade::eye(radii);
    json!({"look_from": {"eye": eye.to_array(), "forward": (-eye).to_array()}})
}

#[test]
fn error_metric_and_budget_change_what_is_drawn() {
    let stand = Stand::new();
    let file = balls(&stand);
    let (near, far) = (from(8.0), from(400.0));
    stand.script(
        &file,
        &json!([
            far, {"frames": 2}, {"dump": "far.json"}, {"proxies": false}, {"dump": "off.json"}, {"proxies": true},
            near, {"detail": 0}, {"metric": "sse"}, {"dump": "fine.json"}, {"detail": 500}, {"dump": "coarse.json"},
            "measure", {"dump": "measured.json"}, {"detail": 0},
            {"triangle_budget": 3000}, {"dump": "budget.json"}, "no_budget",
            {"metric": "sigmoid:0.9,0.05"}, {"dump": "sigmoid.json"}, {"metric": "linear"}, {"dump": "linear.json"},
        ]),
    );
    let figures = |name: &str, figure: &str| number(&stand.dump(&format!("{name}.json"))["figures"][figure]);
    let objects = (SIDE * SIDE) as f64;
    assert_eq!(
        (figures("far", "proxies"), figures("far", "nodes"), figures("far", "objects")),
        (1.0, 1.0, 1.0)
    );
    assert_eq!((figures("off", "proxies"), figures("off", "objects")), (0.0, objects));
    assert_eq!((figures("fine", "proxies"), figures("fine", "simplified")), (0.0, 0.0));
    assert!(figures("coarse", "triangles") < 0.5 * figures("fine", "triangles"));
    // What a proxy stands for is not missing.
    assert_eq!(stand.dump("measured.json")["missing"]["pixels"], 0);
    assert!(figures("budget", "triangles") <= 3000.0 && figures("budget", "proxies") > 0.0);
    let state = stand.dump("sigmoid.json")["state"].clone();
    assert_eq!(state["metric"], "sigmoid");
    assert!(
        (number(&state["sigmoid_s"]) - 0.9).abs() < 1e-6 && (number(&state["sigmoid_t"]) - 0.05).abs() < 1e-6
    );
    assert_eq!(stand.dump("linear.json")["state"]["metric"], "linear");
}

#[test]
fn colours_tell_proxies_and_how_much_their_error_counts() {
    let stand = Stand::new();
    let file = balls(&stand);
    stand.script(
        &file,
        &json!([
            from(6.0), {"metric": "sse"}, {"detail": 500}, {"colours": "proxies"}, {"frames": 2},
            {"screenshot": "proxies.png"}, {"proxies": false}, {"frames": 2}, {"screenshot": "objects.png"}, {"proxies": true},
            {"colours": "severity"}, {"frames": 2}, {"screenshot": "severity.png"}, {"click": [476, 400]},
            {"dump": "picked.json"},
        ]),
    );
    let orange = |name: &str| {
        stand.share(name, |[r, g, b]| r > 100 && r > g.saturating_add(30) && g > b.saturating_add(20))
    };
    assert!(orange("proxies.png") > orange("objects.png") + 0.01);
    // The error counts in full: blue.
    let blue = |name: &str| {
        stand.share(name, |[r, g, b]| b > 90 && b > r.saturating_add(60) && b > g.saturating_add(60))
    };
    assert!(blue("severity.png") > blue("objects.png") + 0.01);
    let picked = &stand.dump("picked.json")["picked"];
    if !picked.is_null() {
        let why = picked["why"].as_str().expect("a reason");
        assert!(why.starts_with("drawn as a proxy of") && why.contains(" objects (error "), "{why}");
    }
}

#[test]
fn the_mouse_reaches_every_control() {
    let stand = Stand::new();
    let file = balls(&stand);
    let mut open = Open::new(&stand, &file);
    // The panel grows by a line once a frame was timed: its controls stand still after that.
    stand.display.xdotool("mousemove 400 400 sleep 0.5 mousemove 410 410 sleep 0.5");
    for (control, metric) in
        [("metric_linear", "linear"), ("metric_sse", "sse"), ("metric_sigmoid", "sigmoid")]
    {
        open.click(control);
        open.until(metric, |state| state["state"]["metric"] == metric);
    }
    for (control, value) in [("tau", "tau"), ("sigmoid_s", "sigmoid_s"), ("sigmoid_t", "sigmoid_t")] {
        let before = number(&open.state()["state"][value]);
        let (x, y) = {
            let place = &open.state()["places"][control];
            (number(&place[0]) as i64 + 8, (number(&place[1]) + number(&place[3]) * 0.5) as i64)
        };
        stand.display.xdotool(&format!("mousemove {x} {y} sleep 0.3 mousedown 1 sleep 0.5 mouseup 1"));
        open.until(value, |state| number(&state["state"][value]) < before);
    }
    open.click("proxies");
    open.until("no proxies", |state| state["state"]["proxies"] == false);
    for (control, colours) in [("proxy_colours", "proxies"), ("severity", "severity")] {
        open.click(control);
        open.until(colours, |state| state["state"]["colours"] == colours);
    }
}
