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
    /// Most rays to cast at random; those from surfaces that no ray has seen come on top.
    pub rays: u64,
    /// glTF scene; `None` for the default scene.
    pub scene: Option<usize>,
}

/// Share of the scene's radius (half the diagonal of its box) that a camera keeps free around itself by default.
pub const DEFAULT_CLEARANCE: f64 = 0.005;

impl Default for HiddenOptions {
    fn default() -> Self {
        Self {
            mode: RemoveMode::default(),
            clearance: None,
            max_missing_ppm: 0.5,
            rays: 1 << 25,
            scene: None,
        }
    }
}
