//! `svs view`: the viewer.

use super::args::View;
use super::error::Failure;
use super::file;
use svs::camera_path::CameraPath;
use svs::view::{self, ViewOptions};

pub(crate) fn run(args: &View) -> Result<(), Failure> {
    // A name that is wrong is said here, not in a window; what is in the file is said there.
    if let Some(path) = &args.file
        && let Err(error) = std::fs::File::open(path)
    {
        return Err(Failure::doing("read", path, &error));
    }
    if let Some(path) = &args.screenshot {
        file::check_folder(path)?;
    }
    let camera = args
        .camera
        .as_deref()
        .map(|path| CameraPath::read(path).map_err(|error| Failure::doing("read", path, &error)))
        .transpose()?;
    let options = ViewOptions {
        file: args.file.clone(),
        quality: args.quality,
        method: args.method,
        camera,
        size: args.size,
        screenshot: args.screenshot.clone(),
        frames: args.after,
        script: args.script.clone(),
    };
    view::run(&options).map_err(|error| Failure::Input(error.to_string()))
}
