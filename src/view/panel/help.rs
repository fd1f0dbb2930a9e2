//! All keys.

use super::Viewer;
use crate::view::keys::BINDINGS;
use egui::{Align2, Context, Grid, RichText, Window};

const MOUSE: [(&str, &str); 9] = [
    ("left drag", "turn (walk: look)"),
    ("right or middle drag", "shift the image; also left drag with Shift"),
    ("wheel", "zoom (walk: speed)"),
    ("click", "select an object"),
    ("double click", "select and frame it"),
    ("W A S D, arrows", "go"),
    ("Space, C", "rise, sink"),
    ("Shift", "faster"),
    ("drop a file", "open it"),
];

pub(super) fn show(context: &Context, viewer: &mut Viewer) {
    let mut open = viewer.state.help;
    Window::new("Mouse and keys")
        .open(&mut open)
        .anchor(Align2::CENTER_CENTER, [-160.0, 0.0])
        .collapsible(false)
        .resizable(false)
        .show(context, |ui| {
            ui.horizontal_top(|ui| {
                Grid::new("mouse").num_columns(2).spacing([14.0, 4.0]).show(ui, |ui| {
                    for (what, does) in MOUSE {
                        ui.label(RichText::new(what).strong());
                        ui.label(does);
                        ui.end_row();
                    }
                });
                ui.add_space(16.0);
                Grid::new("keys").num_columns(2).spacing([14.0, 4.0]).show(ui, |ui| {
                    for (_, name, _, does) in BINDINGS {
                        ui.label(RichText::new(name).strong());
                        ui.label(does);
                        ui.end_row();
                    }
                });
            });
        });
    viewer.state.help = open;
}
