//! Colours and overlays.

use super::{Viewer, checkbox, place};
use crate::view::state::Colours;
use egui::Ui;

pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    // Those of proxies are with the proxies.
    let own = [Colours::Material, Colours::Object, Colours::Level, Colours::Importance];
    choice(ui, viewer, &own);
    ui.horizontal(|ui| {
        let hover = "Draws the spheres that answer from here, the largest first (key O).";
        checkbox(ui, viewer, "spheres", "Spheres in use", hover, |viewer| &mut viewer.state.spheres);
        if viewer.state.spheres {
            ui.label(format!("{}", viewer.spheres));
        }
        let hover = "Graphs of the last 240 frames (key G).";
        checkbox(ui, viewer, "graphs", "Graphs", hover, |viewer| &mut viewer.state.graphs);
        let hover = "Draws all the time instead of only when something changes: for watching the figures.";
        checkbox(ui, viewer, "continuous", "Continuous", hover, |viewer| &mut viewer.state.continuous);
    });
}

/// What colours mean: one of these.
pub(super) fn choice(ui: &mut Ui, viewer: &mut Viewer, offered: &[Colours]) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for &colours in offered {
            let (name, label, hover) = match colours {
                Colours::Material => ("material", colours.label(), "As the file says."),
                Colours::Object => ("object_colours", colours.label(), "Another colour for each object."),
                Colours::Level => (
                    "level",
                    colours.label(),
                    "How far outside an object is still seen, from any side: dark inside its innermost group only, bright \
                     from outside the whole tree.",
                ),
                Colours::Importance => {
                    ("importance", colours.label(), "The largest visible size in any direction: dark small, bright large.")
                }
                Colours::Proxies => (
                    "proxy_colours",
                    "colour proxies",
                    "Proxies orange, simplified objects blue, objects as they are grey.",
                ),
                Colours::Severity => (
                    "severity",
                    "colour severity",
                    "How much less the error counts because little is visible: blue not at all, red wholly.",
                ),
            };
            let there = viewer.scene.as_ref().is_none_or(|scene| scene.has(colours));
            ui.add_enabled_ui(there, |ui| {
                let chosen = viewer.state.colours == colours;
                let response = ui
                    .selectable_label(chosen, label)
                    .on_hover_text(format!("{hover} Key B: next colours."))
                    .on_disabled_hover_text("Only for files with baked visibility.");
                if response.clicked() {
                    viewer.state.colours = if chosen { Colours::Material } else { colours };
                }
                place(viewer, name, &response);
            });
        }
    });
}
