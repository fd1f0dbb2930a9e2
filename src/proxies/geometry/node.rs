//! The proxy of one node.

use super::class::ClassMesh;
use super::fidelity::{Fidelity, Place, Target, moved, thinned};
use super::gather::{Part, gather};
use super::likeness::looks;
use super::measure::{Reference, places};
use super::palette::Palette;
use super::reduce::{Strategy, reduce};
use super::soup::Soup;
use super::visible::visible_triangles;
use super::weld::weld;

/// How a proxy is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeOptions {
    /// Wanted number of triangles, at most.
    pub target_triangles: usize,
    /// Error that is always allowed, metres: fewer triangles than wanted if they do within it.
    pub tolerance: f64,
    /// Only what can be seen from outside of the node's sphere.
    pub visible_only: bool,
    /// Points of each surface that the error is measured with (area samples, and as many vertices).
    pub samples: usize,
}

impl Default for NodeOptions {
    fn default() -> Self {
        Self { target_triangles: 2000, tolerance: 0.0, visible_only: true, samples: 1500 }
    }
}

/// The geometry of a proxy.
#[derive(Clone, Debug, PartialEq)]
pub struct ProxyGeometry {
    /// Its triangles, one mesh per material class.
    pub classes: Vec<ClassMesh>,
    /// Geometric error: largest measured distance between it and what it stands for (its visible part), metres. With
    /// proxies among the parts: that from the parts, plus the largest error of a part.
    pub error: f64,
    /// By area: against what it stands for, proxies among the parts or not, where something is missing, and against the
    /// parts where something is added.
    pub fidelity: Fidelity,
    /// Places on what it stands for (its visible part).
    pub(super) places: Vec<Place>,
    /// Number of triangles.
    pub triangles: usize,
    /// Triangles of the parts, without those that have no area or are repeated.
    pub gathered: usize,
    /// How many of them are visible.
    pub visible: usize,
    /// How they were reduced.
    pub strategy: Strategy,
}

/// Makes the stand-in of `parts`: gathers them by material class, drops what cannot be seen from outside, reduces the rest
/// to the wanted number of triangles in several ways and keeps the way with the smallest measured error.
///
/// Any input is fine: without triangles, with unusable numbers, without connection. The result never has more triangles
/// than the parts, and none that is not finite.
pub fn simplify_node(parts: &[Part<'_>], palette: &Palette, options: &NodeOptions) -> ProxyGeometry {
    let mut soup = gather(parts, palette);
    let gathered = soup.triangle_count();
    let seen = options.visible_only.then(|| visible_triangles(&soup, palette));
    let places = originals(parts, palette, &soup, seen.as_deref(), options);
    if let Some(seen) = seen {
        soup.indices = soup.filtered(|t| seen[t]);
    }
    let soup = weld(&soup, 0.0);
    let visible = soup.triangle_count();
    let reference = Reference::of_soup(&soup, options.samples);
    let (reduced, strategy) = best(&soup, options, &reference);
    let (max, fidelity) = match strategy {
        Strategy::Unchanged if places.is_none() => (0.0, Fidelity::default()),
        _ => reference.compare(&reduced, places.as_deref()),
    };
    let max = if strategy == Strategy::Unchanged { 0.0 } else { max };
    let inherited = parts.iter().fold(0.0f64, |largest, part| match part {
        Part::Mesh { .. } => largest,
        Part::Proxy { geometry, .. } => largest.max(geometry.error),
    });
    let classes = reduced.split();
    ProxyGeometry {
        triangles: classes.iter().map(ClassMesh::triangles).sum(),
        classes,
        // The largest distance from the originals is at least their mean, whatever the parts were measured at.
        error: (max + inherited).max(fidelity.rms),
        fidelity,
        places: thinned(places.as_deref().unwrap_or(reference.places()), options.samples),
        gathered,
        visible,
        strategy,
    }
}

/// Places on what is seen of the originals, if proxies are among the parts: else the soup is all there is.
fn originals(
    parts: &[Part<'_>],
    palette: &Palette,
    soup: &Soup,
    seen: Option<&[bool]>,
    options: &NodeOptions,
) -> Option<Vec<Place>> {
    let proxies = parts.iter().filter_map(|part| match part {
        Part::Proxy { geometry, origin } => Some(moved(&geometry.places, *origin)),
        Part::Mesh { .. } => None,
    });
    let mut all: Vec<Place> = proxies.flatten().collect();
    if all.is_empty() {
        return None;
    }
    let meshes: Vec<Part<'_>> =
        parts.iter().filter(|part| matches!(part, Part::Mesh { .. })).copied().collect();
    let meshes = gather(&meshes, palette);
    all.extend(places(&meshes, &looks(&meshes), options.samples));
    // Some of them are not seen: more than are wanted.
    let mut all = thinned(&all, options.samples * 2);
    if let Some(seen) = seen {
        let nearest = Target::new(soup).nearest(&all);
        let seen: Vec<bool> = nearest.iter().map(|&(_, triangle)| seen[triangle as usize]).collect();
        let mut at = 0;
        all.retain(|_| {
            at += 1;
            seen.get(at - 1).copied().unwrap_or(true)
        });
    }
    Some(thinned(&all, options.samples))
}

fn best(soup: &Soup, options: &NodeOptions, reference: &Reference) -> (Soup, Strategy) {
    let count = soup.triangle_count();
    let allowed = options.tolerance > 0.0;
    if count == 0 || count <= options.target_triangles && !allowed {
        return (soup.clone(), Strategy::Unchanged);
    }
    if allowed {
        let reduced = reduce(soup, 0, options.tolerance as f32, Strategy::Plain);
        let fits =
            || reduced.triangle_count() > 0 && reference.compare(&reduced, None).0 <= options.tolerance;
        if reduced.triangle_count() <= options.target_triangles && fits() {
            return (reduced, Strategy::Plain);
        }
        if count <= options.target_triangles {
            return (soup.clone(), Strategy::Unchanged);
        }
    }
    choose(soup, options.target_triangles, reference)
}

/// Reduces in all ways and keeps the best: within a tenth of the wanted number the one that shows least wrong where it is
/// drawn, else the fewest triangles.
pub(super) fn choose(soup: &Soup, target: usize, reference: &Reference) -> (Soup, Strategy) {
    let limit = reference.diagonal() as f32 * 2.0;
    let enough = target + target / 10;
    let pixel = reference.pixel(target);
    let mut best: Option<((bool, f64), Soup, Strategy)> = None;
    for strategy in Strategy::REDUCING {
        let reduced = reduce(soup, target, limit, strategy);
        let many = reduced.triangle_count() > enough;
        let score = if many { reduced.triangle_count() as f64 } else { reference.trial(&reduced, pixel) };
        if best.as_ref().is_none_or(|best| (many, score) < best.0) {
            best = Some(((many, score), reduced, strategy));
        }
    }
    best.map_or_else(|| (soup.clone(), Strategy::Unchanged), |(_, reduced, strategy)| (reduced, strategy))
}
