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
    pub(super) scale: Scale,
}

/// The value axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scale {
    /// Linear, from 0.
    FromZero,
    /// Linear, from the least value up to this one.
    UpTo(f64),
    /// Powers of ten; values of 0 and below are left out.
    Logarithmic,
}

/// A value axis with its ticks.
struct Axis {
    low: f64,
    high: f64,
    step: f64,
    logarithmic: bool,
}

const WIDTH: f64 = 480.0;
const HEIGHT: f64 = 250.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 40.0;

impl Plot {
    /// The `<svg>` element.
    pub(super) fn svg(&self) -> String {
        let frames = self.series.iter().map(|series| series.values.len()).max().unwrap_or(0);
        let axis = self.axis();
        let x = |frame: f64| LEFT + frame / (frames.saturating_sub(1).max(1) as f64) * (WIDTH - LEFT - RIGHT);
        let y = |value: f64| HEIGHT - BOTTOM - axis.share(value) * (HEIGHT - TOP - BOTTOM);
        let title = escape(&self.title) + if axis.logarithmic { " (logarithmic)" } else { "" };
        let mut svg = format!(
            "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{title}\"><title>{title}</title>\n\
             <text class=\"t\" x=\"{LEFT}\" y=\"16\">{title}</text>\n"
        );
        let bottom = HEIGHT - BOTTOM;
        for (value, label) in axis.ticks() {
            let at = y(value);
            let _ = writeln!(
                svg,
                "<line class=\"g\" x1=\"{LEFT}\" y1=\"{at:.1}\" x2=\"{:.1}\" y2=\"{at:.1}\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
                WIDTH - RIGHT,
                LEFT - 6.0,
                at + 4.0,
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
            let name = escape(&series.name);
            for line in series.values_in_runs(|value| axis.holds(value)) {
                let points: Vec<String> =
                    line.iter().map(|&(at, value)| format!("{:.1},{:.1}", x(at as f64), y(value))).collect();
                let dashes = series.look.dashes;
                let dashes =
                    if dashes.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dashes}\"") };
                let color = series.look.color;
                if let [point] = points.as_slice() {
                    let (px, py) = point.split_once(',').unwrap_or_default();
                    let _ = writeln!(
                        svg,
                        "<circle cx=\"{px}\" cy=\"{py}\" r=\"3\" fill=\"{color}\"><title>{name}</title></circle>"
                    );
                } else {
                    let points = points.join(" ");
                    let _ = writeln!(
                        svg,
                        "<polyline class=\"l\" stroke=\"{color}\"{dashes} points=\"{points}\"><title>{name}</title></polyline>"
                    );
                }
            }
        }
        svg += "</svg>\n";
        svg
    }

    fn axis(&self) -> Axis {
        let logarithmic = self.scale == Scale::Logarithmic;
        let values = self.series.iter().flat_map(|series| &series.values).copied();
        let values = values.filter(|v| v.is_finite() && (!logarithmic || *v >= SMALLEST));
        let (least, most) =
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let linear = |low, high, step| Axis { low, high, step, logarithmic: false };
        let (least, most) = match self.scale {
            _ if least > most => return linear(0.0, 1.0, 0.25),
            Scale::Logarithmic => {
                let (low, high) = (least.log10().floor(), most.log10().ceil());
                let high = high.max(low + 1.0);
                let step = ((high - low) / 6.0).ceil();
                return Axis { low: 10_f64.powf(low), high: 10_f64.powf(high), step, logarithmic };
            }
            Scale::FromZero => (least.min(0.0), most.max(0.0)),
            // All the same and equal to the end: a thousandth is room enough to see that.
            Scale::UpTo(end) => (least.min(end - 1e-3), most.max(end)),
        };
        if most - least <= most.abs().max(least.abs()) * 1e-9 || most - least < SMALLEST {
            return linear(0.0, 1.0, 0.25);
        }
        let step = nice((most - least) / 4.0);
        let low = (least / step + 1e-9).floor() * step;
        linear(low, low + ((most - low) / step - 1e-9).ceil().max(1.0) * step, step)
    }
}

/// Smaller differences are none, and smaller values have no place on a logarithmic axis: powers of ten must stay normal
/// numbers. Nothing that is measured here is that small.
const SMALLEST: f64 = 1e-12;

impl Axis {
    /// Where a value is between the ends, 0 to 1.
    fn share(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.low).log10() / (self.high / self.low).log10()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    fn holds(&self, value: f64) -> bool {
        value.is_finite() && (!self.logarithmic || value >= SMALLEST)
    }

    fn ticks(&self) -> Vec<(f64, String)> {
        if self.logarithmic {
            let decades = (self.high / self.low).log10().round() as usize;
            let value = |decade: usize| self.low * 10_f64.powf(decade as f64);
            // Few decades leave room for lines between them.
            let between: &[f64] = if decades <= 2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
            let all = (0..=decades)
                .step_by(self.step.max(1.0) as usize)
                .flat_map(|decade| between.iter().map(move |m| value(decade) * m));
            let all = all.filter(|value| *value <= self.high * (1.0 + 1e-9));
            return all.map(|value| (value, tick(value, 10_f64.powf(value.log10().floor())))).collect();
        }
        let count = ((self.high - self.low) / self.step).round() as usize;
        let value = |i: usize| self.low + self.step * i as f64;
        (0..=count).map(|i| (value(i), tick(value(i), self.step))).collect()
    }
}

impl Series {
    /// Stretches of values that can be drawn, with their frames.
    fn values_in_runs(&self, can_be: impl Fn(f64) -> bool) -> Vec<Vec<(usize, f64)>> {
        let mut runs = vec![Vec::new()];
        for (frame, &value) in self.values.iter().enumerate() {
            if can_be(value) {
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
        Plot { title: "b".to_owned(), series, scale: Scale::FromZero }
    }

    #[test]
    fn axes_are_round() {
        let ends = |plot: Plot| {
            let axis = plot.axis();
            (axis.low, axis.high, axis.ticks().into_iter().map(|tick| tick.1).collect::<Vec<_>>().join("|"))
        };
        assert_eq!(ends(plot(vec![0.0, 97.0])), (0.0, 100.0, "0|25|50|75|100".to_owned()));
        assert_eq!(ends(plot(vec![3.1])), (0.0, 4.0, "0|1|2|3|4".to_owned()));
        assert_eq!(ends(plot(vec![0.0, 0.0])), (0.0, 1.0, "0|0.25|0.5|0.75|1".to_owned()));
        let logarithmic = |values| Plot { scale: Scale::Logarithmic, ..plot(values) };
        let (low, high, ticks) = ends(logarithmic(vec![3.0, 0.0, 2.1e6]));
        assert!(
            (low, (high / 1e7).round()) == (1.0, 1.0) && ticks == "1|100|10 k|1 M",
            "{low} {high} {ticks}"
        );
        assert_eq!(ends(logarithmic(vec![3.0])), (1.0, 10.0, "1|2|5|10".to_owned()));
        assert_eq!([nice(0.3), nice(2.1), nice(1.0), nice(6.0)], [0.5, 2.5, 1.0, 10.0]);
        assert_eq!([tick(0.25, 0.25), tick(2.5e6, 5e5), tick(1500.0, 500.0)], ["0.25", "2.5 M", "1.5 k"]);
        assert_eq!([tick(0.9995, 5e-4), tick(1.0, 5e-4), tick(50.0, 50.0)], ["0.9995", "1", "50"]);
        let likeness = Plot { scale: Scale::UpTo(1.0), ..plot(vec![1.0, 1.0]) };
        let (low, high, _) = ends(likeness);
        assert!((0.998..1.0).contains(&low) && (high - 1.0).abs() < 1e-9, "{low} to {high}");
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
        fn any_values_can_be_plotted(values in prop::collection::vec(any::<f64>(), 0..40), scale in 0..3_usize) {
            let values = values.into_iter().map(|v| if v.abs() > 1e15 { f64::NAN } else { v }).collect();
            let svg = Plot { scale: [Scale::FromZero, Scale::UpTo(1.0), Scale::Logarithmic][scale], ..plot(values) }.svg();
            prop_assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
            prop_assert!(svg.len() < 20_000);
        }
    }
}
