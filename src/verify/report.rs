//! The result of a verification, for programs (serde) and for people (a text table).

use super::calibrate::CalibrationReport;
use super::published_bake::Sampling;
use super::score::{Frame, Score};
use super::statistics::{Distribution, ratio};
use serde::{Deserialize, Serialize};
use std::fmt::{self, Write as _};

/// What `svs verify` found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VerifyReport {
    /// Objects under test: those that a visibility tree of the file holds.
    pub objects: usize,
    /// Their triangles.
    pub triangles: u64,
    /// Cameras in each group of its own.
    pub cameras_per_group: usize,
    /// Seed of the cameras.
    pub seed: u64,
    /// Pixels per row of the images.
    pub width: u32,
    /// Rows of the images.
    pub height: u32,
    /// How the published method was baked, if it was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub published: Option<PublishedReport>,
    /// One entry per group of cameras and method.
    pub groups: Vec<GroupReport>,
    /// How exact proxies and simplified meshes are, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibration: Option<CalibrationReport>,
    /// Why proxies cannot be used, if they cannot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub broken_proxies: Option<String>,
}

/// How the published method was baked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PublishedReport {
    /// Inner nodes, each with a sphere.
    pub nodes: usize,
    /// Directions.
    pub directions: usize,
    /// Where its rays went.
    pub sampling: Sampling,
    /// Pixels per side of its images.
    pub resolution: u32,
    /// Entries of its visibility vectors.
    pub entries: usize,
}

/// What a method draws and misses in a group of cameras.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GroupReport {
    /// `outside` (all distances), `inside`, or one distance: `outside 1.05r`, …
    pub group: String,
    /// `default`, `quality 0.25`, …, `published`, `at published triangles`, `frustum`.
    pub method: String,
    /// Quality of the runtime's settings, 0 to 1, where the method has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quality: Option<f64>,
    /// Cameras.
    pub cameras: usize,
    /// Objects that are visible but not drawn, mean over frames.
    pub missing_objects: f64,
    /// Pixels that show one of them, per million pixels of the image.
    pub missing_ppm: Distribution,
    /// Drawn objects / visible objects, sums over frames.
    pub overestimation: f64,
    /// Triangles drawn.
    pub triangles: TriangleRatios,
    /// What to know when reading the row.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// Triangles drawn, as sums over frames divided by sums. A divisor of 0 counts as 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TriangleRatios {
    /// Against the exact visible sets.
    pub over_evs: f64,
    /// Against frustum culling alone.
    pub over_frustum: f64,
}

/// Sums of a method over the frames of a group.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Totals {
    pub cameras: usize,
    pub missing_objects: f64,
    pub missing_ppm: Distribution,
    pub drawn_objects: u64,
    pub drawn_triangles: u64,
    pub visible_objects: u64,
    pub visible_triangles: u64,
    pub frustum_triangles: u64,
}

impl Totals {
    /// Sums over frames and the method's score in each.
    pub(super) fn of<'f>(frames: impl Iterator<Item = (&'f Frame, Score)> + Clone) -> Self {
        let mut totals = Self {
            missing_ppm: Distribution::of(frames.clone().map(|(frame, score)| frame.missing_ppm(&score))),
            ..Self::default()
        };
        let mut missing = 0;
        for (frame, score) in frames {
            totals.cameras += 1;
            missing += score.missing_objects;
            totals.drawn_objects += score.drawn_objects;
            totals.drawn_triangles += score.drawn_triangles;
            totals.visible_objects += frame.visible.len() as u64;
            totals.visible_triangles += frame.visible_triangles;
            totals.frustum_triangles += frame.frustum_triangles;
        }
        totals.missing_objects = missing as f64 / totals.cameras.max(1) as f64;
        totals
    }

    /// The row of the report.
    pub(super) fn report(&self, group: &str, method: &str) -> GroupReport {
        GroupReport {
            group: group.to_owned(),
            method: method.to_owned(),
            quality: None,
            cameras: self.cameras,
            missing_objects: self.missing_objects,
            missing_ppm: self.missing_ppm,
            overestimation: ratio(self.drawn_objects, self.visible_objects),
            triangles: TriangleRatios {
                over_evs: ratio(self.drawn_triangles, self.visible_triangles),
                over_frustum: ratio(self.drawn_triangles, self.frustum_triangles),
            },
            note: None,
        }
    }
}

impl VerifyReport {
    /// The row of a group and a method.
    pub fn find(&self, group: &str, method: &str) -> Option<&GroupReport> {
        self.groups.iter().find(|row| row.group == group && row.method == method)
    }
}

/// The table for people: what is missing first.
impl fmt::Display for VerifyReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { objects, triangles, cameras_per_group, width, height, seed, .. } = self;
        writeln!(f, "{objects} objects, {triangles} triangles")?;
        writeln!(f, "{cameras_per_group} cameras per group, {width}x{height}, 60 degrees, seed {seed}")?;
        if let Some(PublishedReport { nodes, directions, sampling, resolution, .. }) = &self.published {
            let how = match sampling {
                Sampling::PerSphere => "orthographic images over each sphere",
                Sampling::RootGrid => "parallel rays over the root's sphere, for all spheres",
            };
            writeln!(
                f,
                "published method: {nodes} spheres, {directions} directions, {resolution}x{resolution} {how}"
            )?;
        }
        if self.groups.is_empty() {
            writeln!(f, "nothing to look at: no object with triangles is in a visibility tree")?;
        }
        for rows in self.groups.chunk_by(|a, b| a.group == b.group) {
            // The sweep at single distances is for programs; people have it for all distances together.
            let is_distance = rows[0].group != "outside" && rows[0].group != "inside";
            let shown: Vec<&GroupReport> =
                rows.iter().filter(|row| !is_distance || !row.method.starts_with("quality")).collect();
            write_group(f, &shown)?;
        }
        if let Some(calibration) = &self.calibration {
            write!(f, "{calibration}")?;
        }
        if let Some(error) = &self.broken_proxies {
            writeln!(f, "proxies cannot be used: {error}")?;
        }
        Ok(())
    }
}

/// Heads of the columns after the method's name.
const HEADS: [(&str, &str); 8] = [
    ("missing", "objects"),
    ("missing ppm", "mean"),
    ("", "median"),
    ("", "p95"),
    ("", "worst"),
    ("drawn/EVS", "objects"),
    ("triangles", "/EVS"),
    ("", "/frustum"),
];

fn write_group(f: &mut fmt::Formatter<'_>, rows: &[&GroupReport]) -> fmt::Result {
    let cells: Vec<[String; HEADS.len()]> = rows.iter().map(|row| cells(row)).collect();
    let names = rows.iter().map(|row| row.method.len()).max().unwrap_or(0);
    let widths: [usize; HEADS.len()] = std::array::from_fn(|column| {
        let (upper, lower) = HEADS[column];
        cells.iter().map(|row| row[column].len()).fold(upper.len().max(lower.len()), usize::max)
    });
    let line = |name: &str, row: [&str; HEADS.len()]| {
        let mut line = format!("  {name:names$}");
        for (cell, width) in row.into_iter().zip(widths) {
            // Writing to a string cannot fail.
            let _ = write!(line, "  {cell:>width$}");
        }
        line.truncate(line.trim_end().len());
        line
    };
    if let Some(first) = rows.first() {
        writeln!(f, "\n{} ({} cameras)", first.group, first.cameras)?;
    }
    writeln!(f, "{}", line("", HEADS.map(|(upper, _)| upper)))?;
    writeln!(f, "{}", line("method", HEADS.map(|(_, lower)| lower)))?;
    for (row, cells) in rows.iter().zip(&cells) {
        writeln!(f, "{}", line(&row.method, cells.each_ref().map(String::as_str)))?;
    }
    for row in rows {
        if let Some(note) = &row.note {
            writeln!(f, "  {}: {note}", row.method)?;
        }
    }
    Ok(())
}

fn cells(row: &GroupReport) -> [String; HEADS.len()] {
    let Distribution { mean, median, p95, worst } = row.missing_ppm;
    [
        format!("{:.2}", row.missing_objects),
        ppm(mean),
        ppm(median),
        ppm(p95),
        ppm(worst),
        format!("{:.2}", row.overestimation),
        format!("{:.2}", row.triangles.over_evs),
        format!("{:.3}", row.triangles.over_frustum),
    ]
}

/// Three digits are as much as some dozens of cameras can tell.
fn ppm(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 10.0 => format!("{v:.1}"),
        v if v > 0.0 => format!("{v:.2}"),
        _ => "0".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn report() -> VerifyReport {
        let totals = Totals {
            cameras: 4,
            missing_objects: 1.25,
            missing_ppm: Distribution { mean: 12.5, median: 0.0, p95: 40.0, worst: 1234.5 },
            drawn_objects: 30,
            drawn_triangles: 600,
            visible_objects: 20,
            visible_triangles: 200,
            frustum_triangles: 1000,
        };
        let mut row = totals.report("inside", "quality 0.5");
        row.quality = Some(0.5);
        row.note = Some("read with care".to_owned());
        VerifyReport {
            objects: 3,
            triangles: 36,
            cameras_per_group: 4,
            seed: 1,
            width: 64,
            height: 36,
            published: None,
            groups: vec![totals.report("outside", "default"), row],
            calibration: None,
            broken_proxies: None,
        }
    }

    #[test]
    fn json_has_the_documented_shape() {
        let json = serde_json::to_value(report()).unwrap();
        let expected = json!({
            "group": "outside", "method": "default", "cameras": 4, "missing_objects": 1.25,
            "missing_ppm": {"mean": 12.5, "median": 0.0, "p95": 40.0, "worst": 1234.5},
            "overestimation": 1.5, "triangles": {"over_evs": 3.0, "over_frustum": 0.6},
        });
        assert_eq!(json["groups"][0], expected);
        assert_eq!(json["groups"][1]["quality"], json!(0.5));
        assert_eq!(serde_json::from_value::<VerifyReport>(json).unwrap(), report());
    }

    #[test]
    fn table_puts_what_is_missing_first() {
        let text = report().to_string();
        let row = text.lines().find(|l| l.contains("default")).unwrap();
        let cells: Vec<&str> = row.split_whitespace().collect();
        assert_eq!(cells, ["default", "1.25", "12.5", "0", "40.0", "1234", "1.50", "3.00", "0.600"]);
        assert!(text.contains("inside (4 cameras)") && text.contains("quality 0.5: read with care"));
        // Every row of a group ends in the same column.
        let head = text.lines().find(|l| l.contains("/frustum")).unwrap();
        assert_eq!(head.len(), row.len());
    }

    #[test]
    fn rows_are_found_by_name() {
        assert_eq!(report().find("inside", "quality 0.5").unwrap().quality, Some(0.5));
        assert!(report().find("inside", "default").is_none());
    }

    #[test]
    fn a_group_that_shows_nothing_has_finite_ratios() {
        let row = Totals { drawn_triangles: 5, ..Totals::default() }.report("inside", "default");
        assert_eq!(row.triangles.over_evs, 5.0);
        assert_eq!(Totals::default().report("inside", "default").triangles.over_evs, 0.0);
    }
}
