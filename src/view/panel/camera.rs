//! Cameras and camera paths.

use super::style::{ERROR, FAINT};
use super::{Viewer, button, place};
use crate::rig::CameraMode;
use egui::{RichText, TextEdit, Ui};

pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (mode, name, label, hover) in [
            (CameraMode::Orbit, "orbit", "Orbit", "Left drag turns, right drag shifts, the wheel zooms (key 1)."),
            (
                CameraMode::Walk,
                "walk",
                "Walk",
                "W A S D go, Space and C rise and sink, Shift is faster, a drag looks, the wheel sets the speed (key 2).",
            ),
        ] {
            let response = ui.selectable_label(viewer.rig.mode() == mode, label).on_hover_text(hover);
            if response.clicked() {
                viewer.rig.switch(mode);
            }
            place(viewer, name, &response);
        }
        if button(ui, viewer, "frame", "Frame all", "Shows the whole scene (key Home).") {
            viewer.frame(false);
        }
        if button(ui, viewer, "help", "Keys", "All keys (key F1).") {
            viewer.state.help = !viewer.state.help;
        }
        if viewer.rig.mode() == CameraMode::Walk {
            let speed = format!("{} m/s", speed(viewer.rig.metres_per_second()));
            ui.label(RichText::new(speed).small().color(FAINT));
        }
    });
    ui.horizontal(|ui| {
        ui.label("Path");
        let edit = TextEdit::singleline(&mut viewer.state.path_file).desired_width(f32::INFINITY);
        let response = ui.add(edit).on_hover_text(
            "Camera path file: written when recording ends; for Play, svs evaluate --path and svs render --camera.",
        );
        place(viewer, "path_file", &response);
    });
    ui.horizontal(|ui| {
        let recording = viewer.tape.is_recording();
        let label = if recording { "Stop and save" } else { "Record" };
        let hover = "Records the camera whenever it moves; walking is slower meanwhile (key R).";
        if button(ui, viewer, "record", label, hover) {
            viewer.record(!recording);
        }
        let playing = viewer.tape.is_playing();
        let label = if playing { "Stop" } else { "Play" };
        if button(ui, viewer, "play", label, "Flies along the path file (key P).") {
            viewer.play(!playing);
        }
        let color = if recording { ERROR } else { FAINT };
        ui.label(RichText::new(viewer.tape.status()).small().color(color));
    });
}

fn speed(metres: f64) -> String {
    if metres < 10.0 { format!("{metres:.2}") } else { format!("{metres:.0}") }
}
