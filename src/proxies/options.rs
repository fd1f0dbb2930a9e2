//! What a user can choose about proxies.

/// Which objects get proxies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ProxyMode {
    /// None.
    #[default]
    Off,
    /// Of what is visible from outside, where they pay.
    Auto,
    /// Of everything, hidden or not: what visibility is measured against.
    All,
}

/// How the vertices of proxies are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ProxyFormat {
    /// Floats: every loader reads them.
    #[default]
    Float,
    /// Normals in bytes and texture coordinates in shorts where they fit: needs `KHR_mesh_quantization`.
    Quantized,
    /// Compressed too, positions on a grid far below the errors: needs `EXT_meshopt_compression` and
    /// `KHR_mesh_quantization`, and readers that do not know both refuse the whole file.
    Meshopt,
}

/// Options of the proxies of a bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProxyOptions {
    /// Which objects get proxies.
    pub mode: ProxyMode,
    /// Error of the finest proxies: pixels of a screen with [`SCREEN_LINES`] lines that the tree's sphere just fills.
    pub error_pixels: f64,
    /// How they are stored.
    pub format: ProxyFormat,
    /// Triangles of originals that the smallest nodes stand for, about; a proxy has at most half as many.
    pub triangles: u32,
    /// Bytes added for them, JSON counted, as a share of the scene's geometry, at most.
    pub share: f64,
    /// Nodes whose mesh gets simplified versions name them in `MSFT_lod` too, for loaders that do not know our extension.
    pub msft_lod: bool,
}

/// See [`ProxyOptions::error_pixels`].
pub const SCREEN_LINES: f64 = 1080.0;

/// See [`ProxyOptions::error_pixels`].
pub const DEFAULT_ERROR_PIXELS: f64 = 0.5;

/// See [`ProxyOptions::triangles`].
pub const DEFAULT_TRIANGLES: u32 = 2000;

/// See [`ProxyOptions::share`].
pub const DEFAULT_SHARE: f64 = 0.2;

impl Default for ProxyOptions {
    fn default() -> Self {
        Self {
            mode: ProxyMode::default(),
            error_pixels: DEFAULT_ERROR_PIXELS,
            format: ProxyFormat::default(),
            triangles: DEFAULT_TRIANGLES,
            share: DEFAULT_SHARE,
            msft_lod: false,
        }
    }
}

impl ProxyOptions {
    /// Error in metres that the finest proxies of a tree with this radius may have.
    pub fn finest_error(&self, radius: f64) -> f64 {
        self.error_pixels.max(0.0) * 2.0 * radius / SCREEN_LINES
    }
}
