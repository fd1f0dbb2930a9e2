//! How it is decided what is drawn.

use super::style::FAINT;
use super::{Viewer, checkbox, place};
use crate::stage::Method;
use crate::view::state::{Limit, State};
use egui::{RichText, Slider, Ui};

pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    method(ui, viewer);
    let visibility = viewer.state.method == Method::Visibility;
    ui.add_enabled_ui(visibility, |ui| quality(ui, viewer));
    let budgets = matches!(viewer.state.method, Method::Visibility | Method::Frustum);
    ui.add_enabled_ui(budgets, |ui| budget(ui, viewer));
    ui.add_space(2.0);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        let hover = "What is drawn stays as it is: fly out and look at it from elsewhere (key X). Yellow lines show the \
                     camera culling goes on looking from.";
        checkbox(ui, viewer, "freeze", "Freeze culling", hover, |viewer| &mut viewer.state.freeze);
        let frozen = viewer.state.freeze;
        ui.add_enabled_ui(frozen, |ui| {
            let hover = "While frozen: draws what is skipped too, in red (key K).";
            checkbox(ui, viewer, "skipped", "skipped", hover, |viewer| &mut viewer.state.skipped);
            let hover = "While frozen: draws red boxes around what is skipped, to look through (key J).";
            checkbox(ui, viewer, "skipped_boxes", "as boxes", hover, |viewer| &mut viewer.state.skipped_boxes);
        });
    });
}

fn method(ui: &mut Ui, viewer: &mut Viewer) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for method in Method::ALL {
            let (name, label, hover) = match method {
                Method::Nothing => ("nothing", "Nothing", "Culls nothing: draws the whole file."),
                Method::Frustum => ("frustum", "Frustum", "Draws what lies in the frustum."),
                Method::Visibility => (
                    "visibility",
                    "Visibility",
                    "Draws what the baked visibility says can be seen from here.",
                ),
                Method::Exact => (
                    "exact",
                    "Exact",
                    "Draws exactly what shows in an item buffer of this frame. Slow: the yardstick.",
                ),
            };
            let chosen = viewer.state.method == method;
            let response =
                ui.selectable_label(chosen, label).on_hover_text(format!("{hover} Key V: next method."));
            if response.clicked() {
                viewer.state.method = method;
            }
            place(viewer, name, &response);
        }
    });
}

fn quality(ui: &mut Ui, viewer: &mut Viewer) {
    let slider = Slider::new(&mut viewer.state.quality, 0.0..=1.0).text("quality").fixed_decimals(2);
    let response = ui.add(slider).on_hover_text(
        "0: fewest triangles. 1: fewest missing pixels. 0.5: each object's own direction, whatever its size. \
         Keys [ and ].",
    );
    place(viewer, "quality", &response);
    ui.label(RichText::new(thresholds(&viewer.state)).small().color(FAINT))
        .on_hover_text("The smallest estimated size (tau), in visible pixels, that is drawn.");
    let slider = Slider::new(&mut viewer.state.sphere_limit, 0.0..=90.0)
        .text("sphere limit")
        .suffix("°")
        .fixed_decimals(0);
    let response = ui.add(slider).on_hover_text(
        "A sphere decides only if it appears at most this large (half-angle). Smaller: fewer spheres are used, more is \
         drawn. 0°: plain frustum culling.",
    );
    place(viewer, "sphere_limit", &response);
}

/// What the quality means in pixels.
fn thresholds(state: &State) -> String {
    let tau = state.settings().tau;
    let name = |pixels: f32| match pixels {
        p if p.is_infinite() => "off".to_owned(),
        0.0 => "all".to_owned(),
        p if p < 10.0 => format!("{p:.1} px"),
        p => format!("{p:.0} px"),
    };
    format!(
        "draws from: own bin {}, triangle {}, ring {}",
        name(tau.nearest),
        name(tau.triangle),
        name(tau.ring)
    )
}

fn budget(ui: &mut Ui, viewer: &mut Viewer) {
    ui.horizontal(|ui| {
        ui.label("Budget");
        ui.spacing_mut().item_spacing.x = 4.0;
        for (limit, name, label, hover) in [
            (Limit::None, "no_budget", "none", "Draws all that culling lets through."),
            (Limit::Triangles, "triangle_budget", "triangles", "Never draws more triangles than this."),
            (
                Limit::Milliseconds,
                "time_budget",
                "time",
                "Draws as much as is expected to take this long, learned from the frames before.",
            ),
        ] {
            let response = ui.selectable_label(viewer.state.limit == limit, label).on_hover_text(hover);
            if response.clicked() {
                viewer.state.limit = limit;
            }
            place(viewer, name, &response);
        }
    });
    let response = match viewer.state.limit {
        Limit::None => return,
        Limit::Triangles => {
            let slider = Slider::new(&mut viewer.state.triangles, 1_000..=100_000_000).logarithmic(true);
            ui.add(slider.text("triangles")).on_hover_text("Triangles per frame, at most.")
        }
        Limit::Milliseconds => {
            let slider = Slider::new(&mut viewer.state.milliseconds, 0.5..=500.0).logarithmic(true);
            ui.add(slider.text("per frame").suffix(" ms"))
                .on_hover_text("Milliseconds per frame, as predicted.")
        }
    };
    place(viewer, "budget", &response);
}
