//! The proxy of one node.

use super::class::ClassMesh;
use super::gather::{Part, gather};
use super::measure::{Deviation, Reference};
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
        Self { target_triangles: 2000, tolerance: 0.0, visible_only: true, samples: 3000 }
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
    /// Mean distance, metres, in the same way.
    pub mean_error: f64,
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
    if options.visible_only {
        let visible = visible_triangles(&soup, palette);
        soup.indices = soup.filtered(|t| visible[t]);
    }
    let soup = weld(&soup, 0.0);
    let visible = soup.triangle_count();
    let (reduced, strategy, deviation) = best(&soup, options);
    let inherited = |error: fn(&ProxyGeometry) -> f64| {
        parts.iter().fold(0.0f64, |largest, part| match part {
            Part::Mesh { .. } => largest,
            Part::Proxy { geometry, .. } => largest.max(error(geometry)),
        })
    };
    let classes = reduced.split();
    ProxyGeometry {
        triangles: classes.iter().map(ClassMesh::triangles).sum(),
        classes,
        error: deviation.max + inherited(|geometry| geometry.error),
        mean_error: deviation.mean + inherited(|geometry| geometry.mean_error),
        gathered,
        visible,
        strategy,
    }
}

fn best(soup: &Soup, options: &NodeOptions) -> (Soup, Strategy, Deviation) {
    let count = soup.triangle_count();
    let allowed = options.tolerance > 0.0;
    if count == 0 || count <= options.target_triangles && !allowed {
        return (soup.clone(), Strategy::Unchanged, Deviation::default());
    }
    let reference = Reference::of_soup(soup, options.samples);
    if allowed {
        let reduced = reduce(soup, 0, options.tolerance as f32, Strategy::Plain);
        let (deviation, _) = reference.compare(&reduced);
        let fits = deviation.max <= options.tolerance;
        if fits && reduced.triangle_count() <= options.target_triangles {
            return (reduced, Strategy::Plain, deviation);
        }
        if count <= options.target_triangles {
            return (soup.clone(), Strategy::Unchanged, Deviation::default());
        }
    }
    choose(soup, options.target_triangles, &reference)
}

/// Differences in looks (0 to 1) far below this do not count.
const LEAST_LOOK: f64 = 0.01;

/// Reduces in all ways and keeps the best: within a tenth of the wanted number the smallest product of largest and mean
/// error and squared difference in looks, else the fewest triangles. By the largest error alone clustering wins too often,
/// which moves every vertex a little to spare one spike.
pub(super) fn choose(soup: &Soup, target: usize, reference: &Reference) -> (Soup, Strategy, Deviation) {
    let limit = reference.diagonal() as f32 * 2.0;
    let enough = target + target / 10;
    let mut best: Option<((bool, f64), Soup, Strategy, Deviation)> = None;
    for strategy in Strategy::REDUCING {
        let reduced = reduce(soup, target, limit, strategy);
        let (deviation, look) = reference.compare(&reduced);
        let many = reduced.triangle_count() > enough;
        let error = deviation.max * deviation.mean * (look + LEAST_LOOK).powi(2);
        let score = (many, if many { reduced.triangle_count() as f64 } else { error });
        if best.as_ref().is_none_or(|best| score < best.0) {
            best = Some((score, reduced, strategy, deviation));
        }
    }
    match best {
        Some((_, reduced, strategy, deviation)) => (reduced, strategy, deviation),
        None => (soup.clone(), Strategy::Unchanged, Deviation::default()),
    }
}
