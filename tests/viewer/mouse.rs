//! A real mouse and a real keyboard, through the window system.

use crate::run::{Open, Stand, distance, number, vector};
use serde_json::{Value, json};

fn eye(state: &Value) -> [f64; 3] {
    vector(&state["camera"]["eye"])
}

/// A drag from the middle of the picture, as slowly as a hand does it.
fn drag(button: u32, right: i32, down: i32) -> String {
    format!(
        "mousemove 400 400 sleep 0.3 mousedown {button} sleep 0.3 mousemove_relative -- {} {} sleep 0.3 \
         mousemove_relative -- {} {} sleep 0.5 mouseup {button}",
        right / 2,
        down / 2,
        right / 2,
        down / 2
    )
}

#[test]
fn mouse_and_keyboard_move_cameras_and_change_settings() {
    let stand = Stand::new();
    let plant = stand.plant();
    let mut open = Open::new(&stand, &plant);
    let start = open.state();
    let at = eye(&start);

    // Left drag turns, right drag shifts, the wheel zooms.
    stand.display.xdotool(&drag(1, 120, 30));
    let turned = open.until("a turn", |state| distance(eye(state), at) > 1.0);
    let forward = turned["camera"]["forward"].clone();
    stand.display.xdotool(&drag(3, 80, 0));
    let panned = open.until("a shift", |state| distance(eye(state), eye(&turned)) > 0.5);
    assert_eq!(panned["camera"]["forward"], forward);
    stand.display.xdotool("mousemove 400 400 sleep 0.2 click 4 sleep 0.2 click 4");
    open.until("a zoom", |state| distance(eye(state), eye(&panned)) > 0.5);

    // Controls of the panel.
    open.click("frustum");
    let frustum = open.until("frustum culling", |state| state["state"]["method"] == "frustum");
    open.click("visibility");
    open.until("fewer triangles", |state| {
        number(&state["figures"]["triangles"]) < number(&frustum["figures"]["triangles"])
    });
    let (x, y) = {
        let place = &open.state()["places"]["quality"];
        (number(&place[0]) as i64 + 8, (number(&place[1]) + number(&place[3]) * 0.5) as i64)
    };
    stand.display.xdotool(&format!("mousemove {x} {y} sleep 0.3 mousedown 1 sleep 0.5 mouseup 1"));
    open.until("a low quality", |state| number(&state["state"]["quality"]) < 0.1);
    open.click("spheres");
    open.until("spheres", |state| state["state"]["spheres"] == true);
    open.click("object_colours");
    open.until("colours of objects", |state| state["state"]["colours"] == "object");
    open.click("triangle_budget");
    open.until("a budget", |state| state["state"]["limit"] == "triangles");
    open.click("measure");
    open.until("a measurement", |state| state["missing"] != json!(null));

    // An object, then its button.
    stand.display.xdotool("mousemove 476 400 sleep 0.2 click 1");
    open.until("a selection", |state| {
        state["picked"] != json!(null) && state["places"]["hide"] != json!(null)
    });
    open.click("hide");
    open.until("a hidden object", |state| state["hidden"] == 1 && state["places"]["show_all"] != json!(null));
    open.click("show_all");
    open.until("all objects", |state| state["hidden"] == 0);

    // Keys: freeze, fly with W held down, Tab does not walk through the controls.
    open.key("x");
    let frozen = open.until("frozen culling", |state| state["state"]["freeze"] == true);
    open.key("Tab");
    let walking = open.until("the walk camera", |state| state["camera"]["mode"] == "walk");
    stand.display.xdotool("keydown w sleep 0.5 keyup w");
    open.until("a walk", |state| distance(eye(state), eye(&walking)) > 0.5);
    assert_eq!(open.state()["drawn"], frozen["drawn"]);
    open.key("F1");
    open.until("help", |state| state["state"]["help"] == true);
    open.key("Escape");
    open.until("no help", |state| state["state"]["help"] == false);

    // Text goes into the field, not to the keys: its letters must not press R, P or X.
    let frozen = open.state()["state"]["freeze"].clone();
    let (x, y) = open.middle("path_file");
    stand.display.xdotool(&format!("mousemove {x} {y} click --repeat 3 1 sleep 0.2 type xr"));
    let typed = open
        .until("typed text", |state| state["state"]["path_file"].as_str().is_some_and(|t| t.contains("xr")));
    assert_eq!((&typed["state"]["freeze"], &typed["tape"]), (&frozen, &json!("")));
}
