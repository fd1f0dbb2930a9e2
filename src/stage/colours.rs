//! Colours that show something else than materials: which object it is, how high its visible level is, how important,
//! whether it is a proxy, and how much its visibility has coarsened it.

use super::{Extra, Stage};
use std::str::FromStr;

/// What objects are coloured by, instead of their materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColourMode {
    /// Each object has a colour of its own.
    Object,
    /// By the highest level at which the object is visible from any direction, as a share of its depth: dark is hidden in
    /// the innermost group, bright is seen from outside the whole tree.
    Level,
    /// By the largest visible area, in square metres, from outside the object's own group; on a logarithmic scale over
    /// the objects of the file.
    Importance,
    /// What it is: objects as they are grey, simplified ones blue, proxies orange, neighbours in different shades.
    Proxies,
    /// Heat map of 1 - P(mu) of what [`Stage::select`] drew last, how much less of its error counts because little of it is
    /// visible: blue is 0, red is 1.
    Severity,
}

impl ColourMode {
    /// All modes.
    pub const ALL: [ColourMode; 5] = [
        ColourMode::Object,
        ColourMode::Level,
        ColourMode::Importance,
        ColourMode::Proxies,
        ColourMode::Severity,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            ColourMode::Object => "object",
            ColourMode::Level => "level",
            ColourMode::Importance => "importance",
            ColourMode::Proxies => "proxies",
            ColourMode::Severity => "severity",
        }
    }
}

impl FromStr for ColourMode {
    type Err = UnknownColourMode;

    fn from_str(name: &str) -> Result<Self, UnknownColourMode> {
        let mode = ColourMode::ALL.into_iter().find(|mode| mode.name() == name);
        mode.ok_or_else(|| UnknownColourMode { name: name.to_owned() })
    }
}

/// A name that no colour mode has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no colour mode {name:?}: use object, level, importance, proxies or severity")]
pub struct UnknownColourMode {
    /// What was asked for.
    pub name: String,
}

/// How much of the material's colour a tint replaces, 0 to 255: a little light and shade stays.
const STRENGTH: u8 = 217;

/// Of what has no level or importance: objects in no tree.
const UNKNOWN: [u8; 3] = [128, 128, 128];

/// Objects as they are, simplified ones, and proxies.
const PLAIN: [u8; 3] = [200, 200, 195];
const SIMPLIFIED: [u8; 3] = [60, 130, 240];
const PROXY: [u8; 3] = [250, 140, 30];

/// Smallest span of the importance scale, in powers of ten, so that equal areas do not get the ends of the palette.
const LEAST_DECADES: f64 = 1.0;

/// The palette "viridis" (Smith and van der Walt 2015; public domain) at nine places: evenly brighter, readable without
/// red or green.
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

impl Stage {
    /// A tint for each object, then for each level (its object's, where the mode is about objects) and each proxy (that of
    /// the first object it stands for): sRGB, and how much it replaces the material's colour.
    pub fn tints(&self, mode: ColourMode) -> Vec<[u8; 4]> {
        let mut colours: Vec<[u8; 3]> = match mode {
            ColourMode::Object => self.each(object_colour),
            ColourMode::Level => {
                let level = |object: u32| {
                    let (tree, place) = self.place(object)?;
                    let depth = tree.depth(place).max(1);
                    Some(f64::from(tree.max_level(place)) / f64::from(depth))
                };
                self.each(|object| level(object).map_or(UNKNOWN, palette))
            }
            ColourMode::Importance => {
                let areas: Vec<Option<f64>> = self.each(|object| self.importance(object));
                let known = areas.iter().flatten().map(|area| area.log10());
                let (low, high) = known
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
                let span = (high - low).max(LEAST_DECADES);
                let share = |area: f64| 1.0 - (high - area.log10()) / span;
                areas.iter().map(|area| area.map_or(UNKNOWN, |area| palette(share(area)))).collect()
            }
            ColourMode::Proxies => self.each(|object| shade(PLAIN, object)),
            ColourMode::Severity => self.each(|_| UNKNOWN),
        };
        for (id, extra) in self.extras.iter().flat_map(|extras| extras.all()) {
            colours.push(match (mode, extra) {
                (ColourMode::Proxies, Extra::Level { object, .. }) => shade(SIMPLIFIED, object),
                (ColourMode::Proxies, Extra::Proxy { .. }) => shade(PROXY, id),
                (ColourMode::Severity, _) => UNKNOWN,
                (_, Extra::Level { object, .. }) => colours[object as usize],
                (ColourMode::Object, Extra::Proxy { .. }) => object_colour(id),
                (_, Extra::Proxy { .. }) => {
                    self.first_object_of(id).map_or(UNKNOWN, |object| colours[object as usize])
                }
            });
        }
        if mode == ColourMode::Severity {
            for (id, ratio) in self.ratios() {
                if let Some(colour) = colours.get_mut(id as usize) {
                    *colour = heat(1.0 - f64::from(ratio));
                }
            }
        }
        colours.into_iter().map(|[r, g, b]| [r, g, b, STRENGTH]).collect()
    }

    /// Largest visible area of an object, in square metres, seen from outside its own group; `None` if none is stored.
    pub fn importance(&self, object: u32) -> Option<f64> {
        let (tree, place) = self.place(object)?;
        Some(f64::from(tree.importance_area(place, 1))).filter(|&area| area > 0.0)
    }

    fn each<T>(&self, of: impl Fn(u32) -> T) -> Vec<T> {
        (0..self.triangles.len() as u32).map(of).collect()
    }

    /// The tree that decides about an object, and the object's place in it.
    pub(super) fn place(&self, object: u32) -> Option<(&svs_runtime::Tree, usize)> {
        let draw = self.draw_of(object)?;
        Some((self.trees().get(draw.tree as usize)?, draw.object as usize))
    }
}

/// One colour in one of several shades, so that neighbours differ.
fn shade(colour: [u8; 3], index: u32) -> [u8; 3] {
    let strength = 0.62 + 0.38 * (f64::from(index) * 0.618_033_988_749_895).fract();
    colour.map(|channel| (f64::from(channel) * strength).round() as u8)
}

/// The colour of a severity: blue at 0, magenta between, red at 1.
pub fn heat(severity: f64) -> [u8; 3] {
    let share = if severity.is_nan() { 0.0 } else { severity.clamp(0.0, 1.0) };
    let channel = |strength: f64| ((2.0 * strength).min(1.0) * 235.0).round() as u8;
    [channel(share), 20, channel(1.0 - share)]
}

/// A colour for each object: hues by the golden ratio, so that neighbours in the list differ, in three brightnesses.
pub fn object_colour(object: u32) -> [u8; 3] {
    let hue = (f64::from(object) * 0.618_033_988_749_895).fract() * 6.0;
    let (value, saturation) = [(0.95, 0.65), (0.75, 0.8), (0.85, 0.45)][(object / 7 % 3) as usize];
    [5.0, 3.0, 1.0].map(|offset: f64| {
        let k = (offset + hue) % 6.0;
        let share = value * (1.0 - saturation * k.min(4.0 - k).clamp(0.0, 1.0));
        (share * 255.0).round() as u8
    })
}

/// The colour of a share from 0 (dark) to 1 (bright).
pub fn palette(share: f64) -> [u8; 3] {
    let last = VIRIDIS.len() - 1;
    let at = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) * last as f64 };
    let below = (at as usize).min(last - 1);
    std::array::from_fn(|channel| {
        let (a, b) = (f64::from(VIRIDIS[below][channel]), f64::from(VIRIDIS[below + 1][channel]));
        (a + (b - a) * (at - below as f64)).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_palette_gets_brighter() {
        let brightness = |share: f64| {
            let [r, g, b] = palette(share).map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        assert!((0..100).all(|i| brightness(f64::from(i) / 100.0) < brightness(f64::from(i + 1) / 100.0)));
        assert_eq!((palette(-1.0), palette(2.0)), (VIRIDIS[0], VIRIDIS[8]));
        assert_eq!(palette(f64::NAN), VIRIDIS[0]);
    }

    #[test]
    fn heat_goes_from_blue_over_magenta_to_red() {
        assert_eq!([heat(0.0), heat(0.5), heat(1.0)], [[0, 20, 235], [235, 20, 235], [235, 20, 0]]);
        assert_eq!([heat(f64::NAN), heat(-3.0), heat(9.0)], [heat(0.0), heat(0.0), heat(1.0)]);
    }

    #[test]
    fn neighbouring_objects_differ() {
        for object in 0..1_000 {
            let [a, b] = [object_colour(object), object_colour(object + 1)];
            let distance: i32 = (0..3).map(|c| (i32::from(a[c]) - i32::from(b[c])).abs()).sum();
            assert!(distance > 60, "{object}: {a:?} {b:?}");
        }
    }

    #[test]
    fn names_go_both_ways() {
        for mode in ColourMode::ALL {
            assert_eq!(mode.name().parse(), Ok(mode));
        }
        assert!("colour".parse::<ColourMode>().is_err());
    }
}
