//! `svs view`: a window that shows a scene, what of it is drawn, and why.
//!
//! The window shows what the controls set ([`state`]); panel, keys and scripts change the same state. [`app`] owns the
//! window, [`viewer`] everything else, [`scene`] the open file.

mod app;
mod canvas;
mod error;
mod explain;
mod figures;
mod keys;
mod loading;
mod panel;
mod recording;
mod scene;
mod screenshot;
mod script;
mod script_run;
mod state;
mod surface;
mod tints;
mod viewer;

pub use error::ViewError;
pub use script::ScriptError;

use crate::camera_path::CameraPath;
use crate::stage::Method;
use std::path::PathBuf;

/// What to show, and how.
#[derive(Clone, Debug, Default)]
pub struct ViewOptions {
    /// File to open; `None`: the window waits for one to be dropped.
    pub file: Option<PathBuf>,
    /// Quality, 0 to 1; `None`: the default of the runtime.
    pub quality: Option<f32>,
    /// Method; `None`: spherical visibility.
    pub method: Option<Method>,
    /// Where to look from at first: the first pose of a path.
    pub camera: Option<CameraPath>,
    /// Size of the window's inside, pixels; `None`: 1280 x 800.
    pub size: Option<[u32; 2]>,
    /// Picture of the window to write; the window then closes. Its folder must exist.
    pub screenshot: Option<PathBuf>,
    /// Frames to draw before the picture is taken.
    pub frames: u32,
    /// Steps to run, see the module `script` of the source.
    pub script: Option<PathBuf>,
}

/// Opens the window and returns when it was closed.
///
/// # Errors
/// [`ViewError`] if there is no display or no GPU, or if a script fails.
pub fn run(options: &ViewOptions) -> Result<(), ViewError> {
    app::run(options)
}
