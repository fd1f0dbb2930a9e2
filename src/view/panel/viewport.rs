//! The scene's picture, the mouse on it, and messages over it.

use super::style::{ERROR, NOTICE};
use super::{Viewer, place};
use egui::{Align2, Area, Color32, Frame, PointerButton, Pos2, Rect, Response, RichText, Sense, Ui, Vec2};

/// Points of scrolling that are one notch of a wheel.
const POINTS_PER_NOTCH: f32 = 40.0;

pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer, scene: Option<egui::TextureId>) {
    let scale = ui.ctx().pixels_per_point();
    let rect = ui.max_rect();
    // Whole pixels, or the picture would be blurred.
    let min = ((rect.min.to_vec2() * scale).round() / scale).to_pos2();
    let pixels = ((rect.max - min) * scale).floor().max(Vec2::splat(1.0));
    let rect = Rect::from_min_size(min, pixels / scale);
    viewer.viewport = [pixels.x as u32, pixels.y as u32];
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    place(viewer, "viewport", &response);
    match scene.filter(|_| viewer.scene.is_some()) {
        Some(id) => {
            let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            ui.painter().image(id, rect, whole, Color32::WHITE);
        }
        None => {
            ui.painter().rect_filled(rect, 0.0, Color32::from_rgb(22, 24, 28));
            if viewer.loading.is_none() {
                let font = egui::FontId::proportional(20.0);
                let text = "Drop a .glb or .gltf file here";
                ui.painter().text(rect.center(), Align2::CENTER_CENTER, text, font, Color32::from_gray(150));
            }
        }
    }
    mouse(ui, &response, viewer, scale);
    status(ui, viewer, rect);
}

fn mouse(ui: &Ui, response: &Response, viewer: &mut Viewer, scale: f32) {
    let height = f64::from(viewer.viewport[1]);
    let delta = response.drag_delta() * scale;
    let (right, down) = (f64::from(delta.x), f64::from(delta.y));
    let shift = ui.input(|input| input.modifiers.shift);
    if delta != Vec2::ZERO {
        let left = response.dragged_by(PointerButton::Primary);
        if left && !shift {
            viewer.rig.drag(right, down, height);
        } else if left
            || response.dragged_by(PointerButton::Secondary)
            || response.dragged_by(PointerButton::Middle)
        {
            viewer.rig.pan(right, down, height);
        }
    }
    if response.hovered() {
        // With Shift, systems turn the wheel sideways.
        let scroll = ui.input(|input| input.smooth_scroll_delta.x + input.smooth_scroll_delta.y);
        if scroll != 0.0 {
            viewer.rig.wheel(f64::from(scroll / POINTS_PER_NOTCH));
        }
    }
    if response.clicked_by(PointerButton::Primary)
        && let Some(at) = response.interact_pointer_pos()
    {
        let at = (at - response.rect.min) * scale;
        viewer.click(f64::from(at.x), f64::from(at.y));
        if response.double_clicked() {
            viewer.frame(true);
        }
    }
}

/// What happens now, in the upper left corner; messages below it.
fn status(ui: &Ui, viewer: &mut Viewer, rect: Rect) {
    let mut lines: Vec<(String, Color32)> = Vec::new();
    if let Some(loading) = &viewer.loading {
        lines.push((
            format!("loading {} … {:.0} s", loading.name(), loading.elapsed().as_secs_f64()),
            Color32::WHITE,
        ));
    }
    if viewer.state.freeze {
        let what = if viewer.state.skipped { "culling is frozen; red: skipped" } else { "culling is frozen" };
        lines.push((what.to_owned(), Color32::from_rgb(255, 214, 64)));
    }
    if viewer.tape.is_recording() || viewer.tape.is_playing() {
        lines.push((viewer.tape.status(), ERROR));
    }
    if lines.is_empty() && viewer.message.is_none() {
        return;
    }
    let area = Area::new(egui::Id::unique("status")).fixed_pos(rect.min + Vec2::splat(10.0));
    area.constrain_to(rect).show(ui.ctx(), |ui| {
        ui.set_max_width((rect.width() - 40.0).max(100.0));
        Frame::window(ui.style()).show(ui, |ui| {
            for (text, color) in lines {
                ui.label(RichText::new(text).color(color));
            }
            if let Some(message) = viewer.message.clone() {
                ui.horizontal(|ui| {
                    let color = if message.error { ERROR } else { NOTICE };
                    ui.add(egui::Label::new(RichText::new(&message.text).color(color)).wrap());
                    let response = ui.small_button("×").on_hover_text("Close this message.");
                    if response.clicked() {
                        viewer.message = None;
                    }
                    place(viewer, "close_message", &response);
                });
            }
        });
    });
}
