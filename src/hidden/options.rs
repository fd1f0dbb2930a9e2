//! What a user can choose.

/// What is dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RemoveMode {
    /// Objects that cannot be seen.
    #[default]
    Objects,
    /// Those, and triangles of the others that cannot be seen in any object that draws them.
    Triangles,
}

/// Options of [`super::remove`].
#[derive(Clone, Debug)]
pub struct HiddenOptions {
    /// What is dropped.
    pub mode: RemoveMode,
    /// Radius of the sphere that a camera inside the scene needs free of opaque surfaces, metres, above 0;
    /// `None`: [`DEFAULT_CLEARANCE`] of the scene's radius.
    pub clearance: Option<f64>,
    /// Sample until a batch of rays finds at most this many rays per million that see something not seen before.
    pub max_missing_ppm: f64,
    /// Most rays to cast at random, those from surfaces that no ray has seen come on top; `None`: [`RAYS_PER_TRIANGLE`] for
    /// every triangle drawn, within [`DEFAULT_RAYS`].
    pub rays: Option<u64>,
    /// glTF scene; `None` for the default scene.
    pub scene: Option<usize>,
}

/// Share of the scene's radius (half the diagonal of its box) that a camera keeps free around itself by default.
pub const DEFAULT_CLEARANCE: f64 = 0.005;

/// See [`HiddenOptions::rays`]. Triangles take very different shares of the rays: what few places see is why it
/// is not a handful.
pub const RAYS_PER_TRIANGLE: u64 = 64;

/// See [`HiddenOptions::rays`]: least, and most, so that time is bounded.
pub const DEFAULT_RAYS: [u64; 2] = [1 << 25, 1 << 27];

impl HiddenOptions {
    /// Most rays for a scene that draws so many triangles, every object counted.
    pub fn ray_limit(&self, triangles: u64) -> u64 {
        let [least, most] = DEFAULT_RAYS;
        self.rays.unwrap_or_else(|| triangles.saturating_mul(RAYS_PER_TRIANGLE).clamp(least, most))
    }
}

impl Default for HiddenOptions {
    fn default() -> Self {
        Self { mode: RemoveMode::default(), clearance: None, max_missing_ppm: 0.5, rays: None, scene: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_grows_with_the_triangles_within_bounds() {
        let limits =
            [0, 1 << 19, 1_354_230, 1 << 21, u64::MAX].map(|n| HiddenOptions::default().ray_limit(n));
        assert_eq!(limits, [1 << 25, 1 << 25, 86_670_720, 1 << 27, 1 << 27]);
        let own = HiddenOptions { rays: Some(7), ..HiddenOptions::default() };
        assert_eq!(own.ray_limit(u64::MAX), 7);
    }
}
