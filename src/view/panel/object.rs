//! The selected object.

use super::style::{FAINT, GOOD, NOTICE};
use super::{Viewer, button};
use crate::view::figures::grouped;
use egui::{Grid, RichText, Ui};

pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    let hidden = viewer.scene.as_ref().map_or(0, |scene| scene.hidden_count());
    if let Some(picked) = viewer.picked.clone() {
        let name = picked.name.clone().unwrap_or_else(|| "(no name)".to_owned());
        ui.add(egui::Label::new(RichText::new(&name).strong()).truncate()).on_hover_text(name);
        Grid::new("object")
            .num_columns(2)
            .spacing([10.0, 2.0])
            .min_col_width(84.0)
            .min_row_height(16.0)
            .show(ui, |ui| {
                ui.label("Object");
                ui.label(RichText::new(picked.object.to_string()).monospace());
                ui.end_row();
                ui.label("Triangles");
                ui.label(RichText::new(grouped(u64::from(picked.triangles))).monospace());
                ui.end_row();
            });
        let color = if picked.drawn { GOOD } else { NOTICE };
        ui.add(egui::Label::new(RichText::new(&picked.why).color(color)).wrap());
    } else {
        ui.label(RichText::new("Click an object to see why it is drawn.").color(FAINT));
    }
    ui.horizontal(|ui| {
        if let Some(picked) = viewer.picked.clone() {
            let label = if picked.hidden { "Show" } else { "Hide" };
            let hover = "Spheres around a hidden object are not trusted any more (key H).";
            if button(ui, viewer, "hide", label, hover) {
                viewer.hide_selected(!picked.hidden);
            }
            if button(ui, viewer, "frame_object", "Frame", "Moves the camera to it (key F).") {
                viewer.frame(true);
            }
            if button(ui, viewer, "unselect", "Unselect", "Key Esc.") {
                viewer.state.selected = None;
            }
        }
        if hidden > 0 {
            let label = format!("Show all ({hidden} hidden)");
            if button(ui, viewer, "show_all", &label, "Shows everything that was hidden (key U).") {
                viewer.show_all();
            }
        }
    });
}
