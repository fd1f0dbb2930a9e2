//! How the panel looks.

use egui::{Color32, Context, CornerRadius, FontFamily, FontId, TextStyle, Visuals};

/// Grey text: units, notes.
pub(super) const FAINT: Color32 = Color32::from_gray(150);
/// Something failed.
pub(super) const ERROR: Color32 = Color32::from_rgb(255, 120, 110);
/// Something to know.
pub(super) const NOTICE: Color32 = Color32::from_rgb(255, 205, 110);
/// Something is drawn, something is fine.
pub(super) const GOOD: Color32 = Color32::from_rgb(130, 215, 140);

/// Dark, with a little room between things.
pub(crate) fn apply(context: &Context) {
    context.set_theme(egui::Theme::Dark);
    context.all_styles_mut(|style| {
        let mut visuals = Visuals::dark();
        visuals.panel_fill = Color32::from_rgb(30, 32, 36);
        visuals.window_fill = Color32::from_rgb(34, 36, 41);
        visuals.selection.bg_fill = Color32::from_rgb(38, 92, 150);
        visuals.widgets.inactive.corner_radius = CornerRadius::same(3);
        visuals.widgets.noninteractive.fg_stroke.color = Color32::from_gray(205);
        visuals.window_shadow = egui::Shadow::NONE;
        visuals.slider_trailing_fill = true;
        style.visuals = visuals;
        style.spacing.item_spacing = egui::vec2(8.0, 4.0);
        style.spacing.button_padding = egui::vec2(8.0, 2.0);
        style.spacing.interact_size.y = 18.0;
        style.spacing.slider_width = 150.0;
        style.interaction.tooltip_delay = 0.4;
        style.text_styles.insert(TextStyle::Body, FontId::new(13.0, FontFamily::Proportional));
        style.text_styles.insert(TextStyle::Button, FontId::new(13.0, FontFamily::Proportional));
        style.text_styles.insert(TextStyle::Small, FontId::new(11.0, FontFamily::Proportional));
        style.text_styles.insert(TextStyle::Monospace, FontId::new(12.5, FontFamily::Monospace));
    });
}
