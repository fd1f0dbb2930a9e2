//! Live figures.

use super::style::{FAINT, GOOD, NOTICE};
use super::{Viewer, button};
use crate::view::figures::{Figure, grouped};
use crate::view::loading::file_name;
use egui::{Grid, RichText, Ui};

/// The file and what is in it.
pub(super) fn header(ui: &mut Ui, viewer: &Viewer) {
    let Some(scene) = &viewer.scene else {
        ui.heading("svs");
        ui.label(RichText::new("Drop a .glb or .gltf file on the window.").color(FAINT));
        return;
    };
    ui.add(egui::Label::new(RichText::new(file_name(&scene.path)).heading()).truncate())
        .on_hover_text(scene.path.display().to_string());
    let baked = if scene.stage.is_baked() { "baked" } else { "not baked" };
    let text = format!(
        "{} objects, {} triangles, {baked}",
        grouped(scene.object_count() as u64),
        grouped(scene.triangle_count())
    );
    ui.label(RichText::new(text).color(FAINT)).on_hover_text(format!(
        "opened in {:.2} s, {:.1} MiB on the GPU",
        scene.took.as_secs_f64(),
        scene.gpu_bytes() as f64 / f64::from(1 << 20)
    ));
}

/// The last frame.
pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    let last = viewer.history.last();
    let total = viewer.scene.as_ref().map_or((0, 0), |scene| (scene.object_count(), scene.triangle_count()));
    Grid::new("figures").num_columns(3).spacing([10.0, 2.0]).min_col_width(84.0).min_row_height(16.0).show(ui, |ui| {
        let median = |figure| format!("median {:.1}", viewer.history.median(figure));
        row(
            ui,
            "Frame",
            format!("{:.1} ms", last.frame_ms),
            median(Figure::Frame),
            "From the begin of batching until the GPU has drawn the scene. The panel is not counted.",
        );
        row(
            ui,
            "Cull",
            format!("{:.0} µs", last.cull_us),
            median(Figure::Cull),
            "What it took to decide what is drawn.",
        );
        row(
            ui,
            "Objects",
            grouped(last.objects as u64),
            share(last.objects as f64, total.0 as f64),
            "Objects drawn, and their share of the file.",
        );
        row(
            ui,
            "Draw calls",
            grouped(last.draws as u64),
            String::new(),
            "Neighbours of one mesh or material are merged into one call.",
        );
        row(
            ui,
            "Triangles",
            grouped(last.triangles),
            share(last.triangles as f64, total.1 as f64),
            "Triangles drawn, and their share of the file.",
        );
        row(
            ui,
            "Est. missing",
            format!("{:.1} ppm", last.estimated_missing_ppm),
            String::new(),
            "Estimated visible pixels of everything left out for its size or for the budget, per million pixels. \
             Objects that hide each other count each.",
        );
        if let Some(scene) = viewer.scene.as_ref().filter(|scene| scene.cost.frames() > 0) {
            row(
                ui,
                "Cost model",
                format!("± {:.0} %", scene.cost.error() * 100.0),
                "of a frame".to_owned(),
                "How far the cost model, which the time budget uses, was off for frames it had not seen.",
            );
        }
    });
    ui.horizontal(|ui| {
        let hover = "Draws everything into an item buffer and counts the pixels of objects that are not drawn (key M).";
        if button(ui, viewer, "measure", "Measure missing now", hover) {
            viewer.measure();
        }
        if let Some(missing) = viewer.missing {
            let color = if missing.pixels == 0 { GOOD } else { NOTICE };
            ui.label(RichText::new(format!("{:.1} ppm", missing.ppm)).monospace().strong().color(color)).on_hover_text(
                format!(
                    "{} of {} pixels show one of {} objects that are not drawn",
                    grouped(missing.pixels),
                    grouped(missing.of),
                    grouped(missing.objects as u64)
                ),
            );
        }
    });
}

fn row(ui: &mut Ui, name: &str, value: String, detail: String, hover: &str) {
    ui.label(name).on_hover_text(hover);
    ui.label(RichText::new(value).monospace().strong()).on_hover_text(hover);
    ui.label(RichText::new(detail).small().color(FAINT)).on_hover_text(hover);
    ui.end_row();
}

fn share(part: f64, whole: f64) -> String {
    if whole > 0.0 { format!("{:.1} % of all", 100.0 * part / whole) } else { String::new() }
}
