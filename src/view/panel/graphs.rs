//! Graphs of the last frames.

use super::Viewer;
use super::style::FAINT;
use crate::view::figures::{Figure, HISTORY, short, step};
use egui::{Color32, RichText, Ui};
use egui_plot::{GridMark, Line, Plot, PlotPoints};

pub(super) fn show(ui: &mut Ui, viewer: &mut Viewer) {
    let history = &viewer.history;
    ui.add_space(2.0);
    ui.columns(Figure::ALL.len(), |columns| {
        for (ui, figure) in columns.iter_mut().zip(Figure::ALL) {
            ui.horizontal(|ui| {
                ui.label(RichText::new(figure.title()).small().color(FAINT));
                ui.label(RichText::new(short(figure.of(&history.last()))).small().strong());
            });
            let points: Vec<[f64; 2]> = history
                .iter()
                .rev()
                .enumerate()
                .map(|(age, frame)| [-(age as f64), figure.of(frame)])
                .collect();
            let largest = points.iter().map(|point| point[1]).fold(1.0, f64::max);
            Plot::new(figure.title())
                .height(ui.available_height().max(40.0))
                .allow_drag(false)
                .allow_zoom(false)
                .allow_scroll(false)
                .allow_boxed_zoom(false)
                .show_x(false)
                .show_y(false)
                .show_axes([false, true])
                .show_grid([false, true])
                .y_axis_min_width(38.0)
                .y_axis_formatter(|mark, _| short(mark.value))
                .include_x(-(HISTORY as f64))
                .include_x(0.0)
                .y_grid_spacer(move |_| marks(largest))
                .include_y(0.0)
                .include_y(largest * 1.1)
                .show(ui, |plot| {
                    plot.line(
                        Line::new(figure.title(), PlotPoints::from(points)).color(color(figure)).width(1.5),
                    );
                });
        }
    });
}

/// Marks of an axis from 0 up to `largest`.
fn marks(largest: f64) -> Vec<GridMark> {
    let step_size = step(largest);
    let count = (largest / step_size) as usize;
    (0..=count).map(|index| GridMark { value: index as f64 * step_size, step_size }).collect()
}

fn color(figure: Figure) -> Color32 {
    match figure {
        Figure::Frame => Color32::from_rgb(110, 190, 255),
        Figure::Cull => Color32::from_rgb(180, 150, 255),
        Figure::Draws => Color32::from_rgb(130, 215, 140),
        Figure::Triangles => Color32::from_rgb(255, 205, 110),
        Figure::Missing => Color32::from_rgb(255, 130, 120),
    }
}
