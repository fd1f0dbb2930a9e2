//! Reading and writing files, with messages that name them.

use super::error::Failure;
use super::interrupt;
use std::io::Write as _;
use std::path::Path;
use svs::gltf::{Container, Document};

/// Reads a glTF file.
pub(crate) fn read(path: &Path) -> Result<Document, Failure> {
    Document::read(path).map_err(|error| Failure::doing("read", path, &error))
}

/// Refuses, before any work is done, an output that could not be written at its end.
pub(crate) fn check_output(path: &Path) -> Result<(), Failure> {
    if Container::from_path(path).is_none() {
        return Err(Failure::Usage(format!(
            "the output {} must end in .glb or .gltf: its name decides the format",
            path.display()
        )));
    }
    check_folder(path)
}

/// Refuses an output whose folder is not there.
pub(crate) fn check_folder(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::Input(format!("cannot write {}: it is a folder", path.display())));
    }
    let folder = folder(path);
    if folder.is_dir() {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "cannot write {}: there is no folder {}; create it first",
        path.display(),
        folder.display()
    )))
}

/// Writes a glTF file; what was there before stays until the new one is complete.
pub(crate) fn write(document: &Document, path: &Path) -> Result<(), Failure> {
    interrupt::protect(|| document.write(path))
        .map(|_| ())
        .map_err(|error| Failure::doing("write", path, &error))
}

/// Writes a JSON file; what was there before stays until the new one is complete.
pub(crate) fn write_json(value: &serde_json::Value, path: &Path) -> Result<(), Failure> {
    write_bytes(format!("{value:#}\n").as_bytes(), path)
}

/// Writes a picture without its alpha; what was there before stays until the new one is complete.
#[cfg(feature = "render")]
pub(crate) fn write_png(image: &svs_render::Image, path: &Path) -> Result<(), Failure> {
    let rgb: Vec<u8> = image.rgba.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let mut png = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    image::ImageEncoder::write_image(
        encoder,
        &rgb,
        image.width,
        image.height,
        image::ExtendedColorType::Rgb8,
    )
    .map_err(|error| Failure::doing("write", path, &error))?;
    write_bytes(&png, path)
}

/// Writes a file beside its place and renames it.
fn write_bytes(bytes: &[u8], path: &Path) -> Result<(), Failure> {
    let write = || -> std::io::Result<()> {
        let mut file = tempfile::NamedTempFile::new_in(folder(path))?;
        file.write_all(bytes)?;
        file.persist(path)?;
        Ok(())
    };
    interrupt::protect(write).map_err(|error| Failure::doing("write", path, &error))
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}
