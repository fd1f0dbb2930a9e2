//! What the window shows around and on top of the scene.

mod camera;
mod culling;
mod detail;
mod figures;
mod graphs;
mod help;
mod look;
mod object;
mod style;
mod viewport;

pub(crate) use style::apply as apply_style;

use super::viewer::Viewer;
use egui::{CollapsingHeader, Panel, Response, ScrollArea, Ui};

/// Width of the panel, points.
const WIDTH: f32 = 328.0;
/// Height of the graphs, points.
const GRAPHS: f32 = 158.0;

/// Lays everything out; the scene gets what the panel and the graphs leave. `scene` is the scene's picture.
pub(crate) fn show(ui: &mut Ui, viewer: &mut Viewer, scene: Option<egui::TextureId>) {
    viewer.places.clear();
    if viewer.state.panel {
        Panel::right("panel").resizable(false).exact_size(WIDTH).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| sections(ui, viewer));
        });
    }
    if viewer.state.graphs {
        Panel::bottom("graphs").resizable(false).exact_size(GRAPHS).show(ui, |ui| graphs::show(ui, viewer));
    }
    egui::CentralPanel::no_frame().show(ui, |ui| viewport::show(ui, viewer, scene));
    help::show(ui.ctx(), viewer);
}

fn sections(ui: &mut Ui, viewer: &mut Viewer) {
    ui.add_space(4.0);
    figures::header(ui, viewer);
    section(ui, "Figures", |ui| figures::show(ui, viewer));
    section(ui, "Culling", |ui| culling::show(ui, viewer));
    section(ui, "Proxies", |ui| detail::show(ui, viewer));
    section(ui, "Object", |ui| object::show(ui, viewer));
    section(ui, "Look", |ui| look::show(ui, viewer));
    section(ui, "Camera", |ui| camera::show(ui, viewer));
    ui.add_space(8.0);
}

fn section(ui: &mut Ui, title: &str, contents: impl FnOnce(&mut Ui)) {
    ui.add(egui::Separator::default().spacing(5.0));
    CollapsingHeader::new(egui::RichText::new(title).strong())
        .default_open(true)
        .show_unindented(ui, contents);
}

/// Notes where a control is, for tests that use the mouse.
fn place(viewer: &mut Viewer, name: &'static str, response: &Response) {
    let rect = response.rect;
    viewer.places.insert(name, [rect.min.x, rect.min.y, rect.width(), rect.height()]);
}

/// A checkbox that is noted under its name.
fn checkbox(
    ui: &mut Ui,
    viewer: &mut Viewer,
    name: &'static str,
    label: &str,
    hover: &str,
    value: impl Fn(&mut Viewer) -> &mut bool,
) {
    let response = ui.checkbox(value(viewer), label).on_hover_text(hover);
    place(viewer, name, &response);
}

/// A button that is noted under its name; says whether it was clicked.
fn button(ui: &mut Ui, viewer: &mut Viewer, name: &'static str, label: &str, hover: &str) -> bool {
    let response = ui.button(label).on_hover_text(hover);
    place(viewer, name, &response);
    response.clicked()
}
