//! The methods that are compared, and their rows of the report.

use super::cameras::CAMERA_GROUPS;
use super::published_bake::PublishedBake;
use super::report::{GroupReport, Totals};
use super::score::{Frame, Score};
use super::statistics::interpolate_log;
use super::target::Target;
use super::view::View;
use std::collections::BTreeMap;
use svs_runtime::Settings;

/// Qualities of the slider that every verification shows.
const SWEEP: [f32; 13] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.55, 0.6, 0.7, 0.75, 0.8, 0.9, 1.0];

/// Steps of the finer sweep in which the published method's triangles are looked for.
const STEPS: u32 = 512;

/// Anything that draws for a camera at the runtime's settings.
pub(super) trait Slider {
    /// Writes the members to draw into `drawn`.
    fn draw(&mut self, view: &View, settings: &Settings, drawn: &mut Vec<u32>);
}

/// Cameras of one group of the report.
struct Group {
    name: String,
    /// Places in the list of frames.
    frames: Vec<usize>,
}

/// Everything needed to measure methods on frames.
pub(super) struct Measure<'a, S> {
    pub target: &'a Target,
    /// Frames with the place of their group in [`CAMERA_GROUPS`].
    pub frames: &'a [(usize, Frame)],
    pub slider: S,
    pub published: Option<&'a PublishedBake>,
    /// Quality that the file recommends.
    pub recommended: Option<f32>,
}

impl<S: Slider> Measure<'_, S> {
    /// All rows, group by group. `full` adds the sweep of the slider and single distances.
    pub(super) fn rows(mut self, full: bool) -> Vec<GroupReport> {
        let groups = groups(self.frames, full);
        let default = match self.recommended {
            Some(quality) => Settings::from_quality(quality),
            None => Settings::default(),
        };
        let mut methods: Vec<(String, Option<f32>, Vec<Score>)> = Vec::new();
        methods.push(("default".to_owned(), self.recommended, self.at(&default)));
        if full {
            for quality in SWEEP {
                let scores = self.at(&Settings::from_quality(quality));
                methods.push((format!("quality {quality}"), Some(quality), scores));
            }
        }
        let published = self.published.map(|bake| self.published_scores(bake));
        let frustum: Vec<Score> =
            self.frames.iter().map(|(_, f)| f.score(self.target, &mut f.in_frustum.clone())).collect();
        let mut finer = Finer { measure: &mut self, known: BTreeMap::new() };
        let mut rows = Vec::new();
        for group in &groups {
            let row = |finer: &Finer<'_, '_, S>, method: &str, scores: &[Score]| {
                finer.measure.totals(group, scores).report(&group.name, method)
            };
            for (method, quality, scores) in &methods {
                let quality = quality.map(two_decimals);
                rows.push(GroupReport { quality, ..row(&finer, method, scores) });
            }
            if let Some(scores) = &published {
                let totals = finer.measure.totals(group, scores);
                rows.push(totals.report(&group.name, "published"));
                rows.push(finer.at_triangles(group, &totals));
            }
            rows.push(row(&finer, "frustum", &frustum));
        }
        rows
    }

    fn at(&mut self, settings: &Settings) -> Vec<Score> {
        (0..self.frames.len()).map(|frame| self.frame_at(frame, settings)).collect()
    }

    fn frame_at(&mut self, frame: usize, settings: &Settings) -> Score {
        let frame = &self.frames[frame].1;
        let mut drawn = Vec::new();
        self.slider.draw(&frame.view, settings, &mut drawn);
        frame.score(self.target, &mut drawn)
    }

    fn published_scores(&self, bake: &PublishedBake) -> Vec<Score> {
        let mut drawn = Vec::new();
        let score = |(_, frame): &(usize, Frame)| {
            bake.draw(self.target, &frame.view, &mut drawn);
            frame.score(self.target, &mut drawn)
        };
        self.frames.iter().map(score).collect()
    }

    fn totals(&self, group: &Group, scores: &[Score]) -> Totals {
        Totals::of(group.frames.iter().map(|&frame| (&self.frames[frame].1, scores[frame])))
    }
}

/// The slider at any of [`STEPS`] + 1 qualities, each frame measured once.
struct Finer<'m, 'a, S> {
    measure: &'m mut Measure<'a, S>,
    known: BTreeMap<(u32, usize), Score>,
}

impl<S: Slider> Finer<'_, '_, S> {
    fn totals(&mut self, group: &Group, step: u32) -> Totals {
        let settings = Settings::from_quality(quality_of(step));
        let scores: Vec<Score> = group
            .frames
            .iter()
            .map(|&frame| {
                *self.known.entry((step, frame)).or_insert_with(|| self.measure.frame_at(frame, &settings))
            })
            .collect();
        Totals::of(group.frames.iter().map(|&frame| &self.measure.frames[frame].1).zip(scores))
    }

    /// What the slider misses where it draws as many triangles as `published` does: between the two steps around
    /// them, log-log; beyond the slider's range, its nearest end.
    fn at_triangles(&mut self, group: &Group, published: &Totals) -> GroupReport {
        const METHOD: &str = "at published triangles";
        let wanted = published.drawn_triangles;
        let (mut low, mut high) = (0, STEPS);
        let ends = [self.totals(group, low), self.totals(group, high)];
        let end = |totals: &Totals, step: u32, why: &str| GroupReport {
            quality: Some(f64::from(quality_of(step))),
            note: Some(format!("the slider ends at {why} triangles than the published method draws")),
            ..totals.report(&group.name, METHOD)
        };
        if ends[0].drawn_triangles > wanted {
            return end(&ends[0], low, "more");
        }
        if ends[1].drawn_triangles < wanted {
            return end(&ends[1], high, "fewer");
        }
        // A higher quality never draws less.
        let [mut below, mut above] = ends;
        while high - low > 1 {
            let middle = low.midpoint(high);
            let totals = self.totals(group, middle);
            if totals.drawn_triangles <= wanted {
                (low, below) = (middle, totals);
            } else {
                (high, above) = (middle, totals);
            }
        }
        let between = |a: f64, b: f64| {
            let point = |totals: &Totals, y: f64| (totals.drawn_triangles as f64, y);
            interpolate_log(wanted as f64, point(&below, a), point(&above, b))
        };
        let mixed = Totals {
            missing_objects: between(below.missing_objects, above.missing_objects),
            missing_ppm: below.missing_ppm.zip(&above.missing_ppm, between),
            drawn_objects: between(below.drawn_objects as f64, above.drawn_objects as f64).round() as u64,
            drawn_triangles: wanted,
            ..below
        };
        let quality = between(f64::from(quality_of(low)), f64::from(quality_of(high)));
        GroupReport { quality: Some(quality), ..mixed.report(&group.name, METHOD) }
    }
}

fn quality_of(step: u32) -> f32 {
    step as f32 / STEPS as f32
}

/// 0.55 and not 0.550000011920929.
fn two_decimals(quality: f32) -> f64 {
    (f64::from(quality) * 100.0).round() / 100.0
}

/// `outside` and `inside`, then, if `full`, each distance.
fn groups(frames: &[(usize, Frame)], full: bool) -> Vec<Group> {
    let of = |name: String, holds: &dyn Fn(usize) -> bool| Group {
        name,
        frames: (0..frames.len()).filter(|&frame| holds(frames[frame].0)).collect(),
    };
    let mut groups = vec![
        of("outside".to_owned(), &|group| CAMERA_GROUPS[group].is_outside()),
        of("inside".to_owned(), &|group| !CAMERA_GROUPS[group].is_outside()),
    ];
    if full {
        let distances = CAMERA_GROUPS.iter().enumerate().filter(|(_, group)| group.is_outside());
        groups.extend(distances.map(|(place, group)| of(group.name(), &|g| g == place)));
    }
    groups
}
