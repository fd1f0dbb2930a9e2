//! Line plots as inline SVG: no scripts, no fonts of their own, readable in print and without colour.

use std::fmt::Write as _;

/// A line of a plot.
#[derive(Clone, Debug)]
pub(super) struct Series {
    pub(super) name: String,
    pub(super) look: Look,
    /// One value per frame; where it is not finite, the line is broken.
    pub(super) values: Vec<f64>,
}

/// How a line is told from others: by colour, and by its dashes where colours cannot be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Look {
    pub(super) color: &'static str,
    /// `stroke-dasharray`; empty: a full line.
    pub(super) dashes: &'static str,
}

/// A plot over the frames of a path.
#[derive(Clone, Debug)]
pub(super) struct Plot {
    /// What is plotted, with its unit.
    pub(super) title: String,
    pub(super) series: Vec<Series>,
    /// The axis does not reach above this, whatever room it would like.
    pub(super) ceiling: Option<f64>,
    /// The axis begins at 0.
    pub(super) from_zero: bool,
}

const WIDTH: f64 = 480.0;
const HEIGHT: f64 = 250.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 40.0;

impl Plot {
    /// The `<svg>` element with its legend below.
    pub(super) fn svg(&self) -> String {
        let frames = self.series.iter().map(|series| series.values.len()).max().unwrap_or(0);
        let (low, high, step) = self.axis();
        let x = |frame: f64| LEFT + frame / (frames.saturating_sub(1).max(1) as f64) * (WIDTH - LEFT - RIGHT);
        let y = |value: f64| HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM);
        let title = escape(&self.title);
        let mut svg = format!(
            "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{title}\"><title>{title}</title>\n\
             <text class=\"t\" x=\"{LEFT}\" y=\"16\">{title}</text>\n"
        );
        let bottom = HEIGHT - BOTTOM;
        let count = ((high - low) / step).round() as usize;
        for i in 0..=count {
            let value = low + step * i as f64;
            let at = y(value);
            let _ = writeln!(
                svg,
                "<line class=\"g\" x1=\"{LEFT}\" y1=\"{at:.1}\" x2=\"{:.1}\" y2=\"{at:.1}\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                WIDTH - RIGHT,
                LEFT - 6.0,
                at + 4.0,
                tick(value, step),
            );
        }
        let stride = nice((frames.max(2) - 1) as f64 / 6.0).max(1.0);
        let mut frame = 0.0;
        while frame < frames.max(1) as f64 {
            let _ = writeln!(
                svg,
                "<line class=\"a\" x1=\"{0:.1}\" y1=\"{bottom}\" x2=\"{0:.1}\" y2=\"{1}\"/>\
                 <text x=\"{0:.1}\" y=\"{2}\" text-anchor=\"middle\">{frame}</text>",
                x(frame),
                bottom + 4.0,
                bottom + 17.0,
            );
            frame += stride;
        }
        let _ = writeln!(
            svg,
            "<polyline class=\"a\" points=\"{LEFT},{TOP} {LEFT},{bottom} {},{bottom}\"/>\
             <text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">frame</text>",
            WIDTH - RIGHT,
            (LEFT + WIDTH - RIGHT) / 2.0,
            HEIGHT - 6.0,
        );
        for series in &self.series {
            for line in series.values_in_runs() {
                let points: Vec<String> =
                    line.iter().map(|&(at, value)| format!("{:.1},{:.1}", x(at as f64), y(value))).collect();
                let dashes = series.look.dashes;
                let dashes =
                    if dashes.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dashes}\"") };
                let color = series.look.color;
                if let [point] = points.as_slice() {
                    let (px, py) = point.split_once(',').unwrap_or_default();
                    let _ = writeln!(svg, "<circle cx=\"{px}\" cy=\"{py}\" r=\"3\" fill=\"{color}\"/>");
                } else {
                    let points = points.join(" ");
                    let _ = writeln!(
                        svg,
                        "<polyline class=\"l\" stroke=\"{color}\"{dashes} points=\"{points}\"/>"
                    );
                }
            }
        }
        svg += "</svg>\n";
        svg
    }

    /// Lower end, upper end and step of the value axis.
    fn axis(&self) -> (f64, f64, f64) {
        let values = self.series.iter().flat_map(|series| &series.values).copied().filter(|v| v.is_finite());
        let (least, most) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if least > most {
            return (0.0, 1.0, 0.25);
        }
        let most = self.ceiling.unwrap_or(most).max(most);
        let least = if self.from_zero { least.min(0.0) } else { least };
        let span = most - least;
        if span <= most.abs() * 1e-9 {
            // All the same: at half the height, or at the ceiling.
            let room = if self.ceiling == Some(most) { 1e-3 } else { most.abs().max(1.0) };
            let step = room / 4.0;
            return (most - 4.0 * step, most + if self.ceiling.is_some() { 0.0 } else { 4.0 * step }, step);
        }
        let step = nice(span / 4.0);
        let low = (least / step).floor() * step;
        let steps = ((most - low) / step - 1e-9).ceil().max(1.0);
        (low, low + steps * step, step)
    }
}

impl Series {
    /// Stretches of finite values, with their frames.
    fn values_in_runs(&self) -> Vec<Vec<(usize, f64)>> {
        let mut runs = vec![Vec::new()];
        for (frame, &value) in self.values.iter().enumerate() {
            if value.is_finite() {
                if let Some(run) = runs.last_mut() {
                    run.push((frame, value));
                }
            } else {
                runs.push(Vec::new());
            }
        }
        runs.retain(|run| !run.is_empty());
        runs
    }
}

/// The smallest of 1, 2, 2.5 and 5 times a power of ten that is not below `least`, which is above 0.
fn nice(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    let found =
        [1.0, 2.0, 2.5, 5.0].map(|m| m * power).into_iter().find(|&step| step >= least * (1.0 - 1e-9));
    found.unwrap_or(10.0 * power)
}

/// A number of an axis, with the digits that its step needs.
fn tick(value: f64, step: f64) -> String {
    let value = if value.abs() < step * 1e-6 { 0.0 } else { value };
    for (unit, sign) in [(1e9, "G"), (1e6, "M"), (1e3, "k")] {
        if step >= unit / 10.0 && value.abs() >= unit {
            return format!("{} {sign}", short(value / unit, step / unit));
        }
    }
    short(value, step)
}

fn short(value: f64, step: f64) -> String {
    // Two digits of the step: a quarter of a step is a nice one too.
    let digits = (1.0 - step.log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Text for HTML and SVG, in elements and in quoted attributes. Characters that neither may hold become U+FFFD.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\'' => escaped += "&#39;",
            '\t' | '\n' | '\r' => escaped.push(' '),
            c if c.is_control() => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn plot(values: Vec<f64>) -> Plot {
        let look = Look { color: "#000", dashes: "" };
        let series = vec![Series { name: "a".to_owned(), look, values }];
        Plot { title: "b".to_owned(), series, ceiling: None, from_zero: true }
    }

    #[test]
    fn axes_are_round() {
        assert_eq!(plot(vec![0.0, 97.0]).axis(), (0.0, 100.0, 25.0));
        assert_eq!(plot(vec![3.1]).axis(), (0.0, 4.0, 1.0));
        assert_eq!([nice(0.3), nice(2.1), nice(1.0), nice(6.0)], [0.5, 2.5, 1.0, 10.0]);
        assert_eq!([tick(0.25, 0.25), tick(2.5e6, 5e5), tick(1500.0, 500.0)], ["0.25", "2.5 M", "1.5 k"]);
        assert_eq!([tick(0.9995, 5e-4), tick(1.0, 5e-4), tick(50.0, 50.0)], ["0.9995", "1", "50"]);
        let likeness = Plot { ceiling: Some(1.0), from_zero: false, ..plot(vec![1.0, 1.0]) };
        let (low, high, _) = likeness.axis();
        assert!(low < 1.0 && high == 1.0, "{low} to {high}");
    }

    #[test]
    fn gaps_break_the_line() {
        let broken = plot(vec![1.0, 2.0, f64::NAN, 3.0, f64::INFINITY, 1.0, 4.0]);
        let svg = broken.svg();
        assert_eq!((svg.matches("class=\"l\"").count(), svg.matches("<circle").count()), (2, 1), "{svg}");
    }

    #[test]
    fn texts_are_escaped() {
        assert_eq!(escape("<a href=\"x\">&'\u{1}"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;\u{fffd}");
    }

    proptest! {
        #[test]
        fn any_values_can_be_plotted(values in prop::collection::vec(any::<f64>(), 0..40), from_zero: bool) {
            let values = values.into_iter().map(|v| if v.abs() > 1e15 { f64::NAN } else { v }).collect();
            let svg = Plot { from_zero, ..plot(values) }.svg();
            prop_assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
            prop_assert!(svg.len() < 20_000);
        }
    }
}
