//! What a user can choose.

use super::hierarchy::HierarchyKind;
use super::spheres::SphereKind;
use crate::proxies::ProxyOptions;
use crate::scene::MaskMode;

/// Presets: what share of the pixels may be missing, and how many rays are spent on it at most.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// A quick look.
    Draft,
    /// For use.
    #[default]
    Standard,
    /// For measuring against.
    High,
}

/// Which hierarchy the visibility tree is made from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HierarchyChoice {
    /// The one with the lowest measured cost.
    #[default]
    Auto,
    /// This one.
    Kind(HierarchyKind),
}

/// Options of a bake. The default is what most scenes want.
#[derive(Clone, Debug)]
pub struct BakeOptions {
    /// Preset for `max_missing_ppm` and `rays`.
    pub quality: Quality,
    /// Missing pixels per million covered ones to stay below, by the sampler's own estimate times three.
    pub max_missing_ppm: Option<f64>,
    /// Name of the direction set.
    pub directions: String,
    /// Most rays to trace.
    pub rays: Option<u64>,
    /// Hierarchy.
    pub hierarchy: HierarchyChoice,
    /// Bounding spheres.
    pub spheres: SphereKind,
    /// Share of triangles that a sphere must cull beyond those kept below it, 0..=1; `None` starts at
    /// [`DEFAULT_PRUNE`] and rises until the data fits [`bytes_allowed`].
    pub prune: Option<f64>,
    /// What becomes of MASK materials.
    pub mask: MaskMode,
    /// glTF scene; `None` for the default scene.
    pub scene: Option<usize>,
    /// Proxies for groups of objects.
    pub proxies: ProxyOptions,
    /// Check the result on held-out cameras at the end.
    pub verify: bool,
}

/// See [`BakeOptions::prune`].
pub const DEFAULT_PRUNE: f64 = 0.05;

/// The direction set used unless another is named.
pub const DEFAULT_DIRECTIONS: &str = "icosahedron-1";

/// Bytes the tables of a scene may take by default: 0.5 % of its geometry or 16 bytes per object, whichever is
/// more.
pub fn bytes_allowed(geometry_bytes: u64, objects: u64) -> u64 {
    (geometry_bytes / 200).max(16 * objects)
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            quality: Quality::default(),
            max_missing_ppm: None,
            directions: DEFAULT_DIRECTIONS.to_owned(),
            rays: None,
            hierarchy: HierarchyChoice::default(),
            spheres: SphereKind::default(),
            prune: None,
            mask: MaskMode::default(),
            scene: None,
            proxies: ProxyOptions::default(),
            verify: true,
        }
    }
}

impl BakeOptions {
    /// Missing pixels per million to stay below, from `max_missing_ppm` or the preset.
    pub fn target_ppm(&self) -> f64 {
        self.max_missing_ppm.unwrap_or(match self.quality {
            Quality::Draft => 1_000.0,
            Quality::Standard => 100.0,
            Quality::High => 20.0,
        })
    }

    /// Most rays: named, or the preset's; with a named target no preset stands in its way.
    pub fn ray_limit(&self) -> u64 {
        self.rays.unwrap_or(match (self.max_missing_ppm, self.quality) {
            (Some(_), _) => 1 << 34,
            (None, Quality::Draft) => 1 << 23,
            (None, Quality::Standard) => 1 << 26,
            (None, Quality::High) => 1 << 29,
        })
    }

    /// Most surfaces that rays may cross in a scene of so many drawn triangles. A ray costs more the more it
    /// crosses and, through the processor's caches, the larger the scene is; so a preset gives fewer rays there.
    pub fn crossing_limit(&self, triangles: u64) -> u64 {
        match (self.rays, self.max_missing_ppm) {
            (None, None) => {
                let size = (LARGE_SCENE / triangles.max(1) as f64).sqrt().min(1.0);
                (self.ray_limit() as f64 * CROSSINGS_PER_RAY * size) as u64
            }
            _ => u64::MAX,
        }
    }

    /// Rays that a scene of so many objects gets whatever they cross: too few per object, and things seen through gaps
    /// are missed. Not more than [`Self::ray_limit`].
    pub fn least_rays(&self, objects: u64) -> u64 {
        let limit = self.ray_limit();
        objects.saturating_mul(limit / FULL_RAYS_OBJECTS).min(limit)
    }
}

/// See [`BakeOptions::crossing_limit`].
const CROSSINGS_PER_RAY: f64 = 4.0;

/// Objects from which on a preset casts all its rays: 512 each at standard quality.
///
/// With 160 each, `sample plant --scale 24` (104,585 objects) missed 2,823 pixels per million inside (SSIM 0.991 in the worst
/// frame), with 640 it missed 477 (0.9986).
const FULL_RAYS_OBJECTS: u64 = 1 << 17;

/// Triangles from which on a ray costs noticeably more.
const LARGE_SCENE: f64 = 1e6;
