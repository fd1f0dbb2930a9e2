//! Proxies: whether, how coarse, and by which metric.

use super::style::FAINT;
use super::{Viewer, checkbox, look, place};
use crate::stage::Method;
use crate::view::state::{Colours, MetricName};
use egui::{RichText, Slider, Ui};

pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    let there = viewer.scene.as_ref().is_none_or(|scene| scene.stage.has_proxies());
    let culls = matches!(viewer.state.method, Method::Visibility | Method::Frustum);
    ui.add_enabled_ui(there && culls, |ui| {
        ui.horizontal(|ui| {
            let hover =
                "Draws what is far or hardly visible simplified, or through the proxy of a whole group.";
            checkbox(ui, viewer, "proxies", "Proxies", hover, |viewer| &mut viewer.state.proxies);
            let last = viewer.history.last();
            if viewer.state.proxies && there {
                let text =
                    format!("{} proxies, {} simplified, {} nodes", last.proxies, last.simplified, last.nodes);
                ui.label(RichText::new(text).small().color(FAINT));
            } else if !there {
                ui.label(RichText::new("none in this file").small().color(FAINT));
            }
        });
        if !there {
            return;
        }
        let on = viewer.state.proxies;
        ui.add_enabled_ui(on, |ui| tau(ui, viewer));
        ui.add_enabled_ui(on, |ui| metric(ui, viewer));
        look::choice(ui, viewer, &[Colours::Proxies, Colours::Severity]);
    });
}

fn tau(ui: &mut Ui, viewer: &mut Viewer) {
    let slider = Slider::new(&mut viewer.state.tau, 0.0..=64.0).logarithmic(true).smallest_positive(0.1);
    let response = ui.add(slider.text("error").suffix(" px")).on_hover_text(
        "What is drawn simplified is off by at most this many pixels (tau), as far as the metric counts it.",
    );
    place(viewer, "tau", &response);
}

fn metric(ui: &mut Ui, viewer: &mut Viewer) {
    ui.horizontal(|ui| {
        ui.label("Metric");
        ui.spacing_mut().item_spacing.x = 4.0;
        for (metric, name, label, hover) in [
            (MetricName::Sse, "metric_sse", "off", "The error counts in full, however little is visible."),
            (
                MetricName::Linear,
                "metric_linear",
                "linear",
                "The error counts in proportion to the visible share.",
            ),
            (
                MetricName::Sigmoid,
                "metric_sigmoid",
                "sigmoid",
                "The error hardly counts below a visible share of t, and nearly in full above it.",
            ),
        ] {
            let response = ui.selectable_label(viewer.state.metric == metric, label).on_hover_text(hover);
            if response.clicked() {
                viewer.state.metric = metric;
            }
            place(viewer, name, &response);
        }
    });
    if viewer.state.metric == MetricName::Sigmoid {
        let slider = Slider::new(&mut viewer.state.sigmoid_s, 0.0..=1.0).text("s").fixed_decimals(2);
        let response = ui.add(slider).on_hover_text("0: linear. 1: a full sigmoid.");
        place(viewer, "sigmoid_s", &response);
        let slider = Slider::new(&mut viewer.state.sigmoid_t, 0.0..=1.0).text("t").fixed_decimals(2);
        let response = ui.add(slider).on_hover_text("The visible share at which the sigmoid turns over.");
        place(viewer, "sigmoid_t", &response);
    }
}
