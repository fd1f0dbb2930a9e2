//! What can be asked for.

use super::ServeError;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Cursor, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Folders inside the site's folder that are looked into.
const DEPTH: usize = 4;

/// Bytes with their type.
#[derive(Debug)]
pub(super) enum Content {
    Bytes(Vec<u8>, &'static str),
    File(PathBuf, &'static str),
}

impl Content {
    /// A file that exists.
    pub(super) fn file(path: &Path) -> std::io::Result<Self> {
        // Absolute, lest it moves with the current folder.
        Ok(Self::File(path.canonicalize()?, kind(path)))
    }

    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Bytes(_, kind) | Self::File(_, kind) => kind,
        }
    }

    pub(super) fn length(&self) -> std::io::Result<u64> {
        match self {
            Self::Bytes(bytes, _) => Ok(bytes.len() as u64),
            Self::File(path, _) => Ok(std::fs::metadata(path)?.len()),
        }
    }

    /// A part of it, inside its length.
    pub(super) fn read(&self, range: Range<u64>) -> std::io::Result<Box<dyn Read + Send + '_>> {
        match self {
            Self::Bytes(bytes, _) => {
                let part = bytes.get(range.start as usize..range.end as usize).unwrap_or_default();
                Ok(Box::new(Cursor::new(part)))
            }
            Self::File(path, _) => {
                let mut file = File::open(path)?;
                file.seek(SeekFrom::Start(range.start))?;
                Ok(Box::new(file.take(range.end - range.start)))
            }
        }
    }
}

/// The viewer's page: its files by the path of a request.
#[derive(Debug)]
pub struct Site {
    files: BTreeMap<String, Content>,
}

impl Site {
    /// Lists the files of a folder that `cargo xtask wasm` has made. Files that come later are not served.
    ///
    /// # Errors
    /// [`ServeError::NoSite`] if there is no `index.html`.
    pub fn open(folder: &Path) -> Result<Self, ServeError> {
        let mut site = Self { files: BTreeMap::new() };
        site.add(folder, "", DEPTH);
        match site.files.contains_key("index.html") {
            true => Ok(site),
            false => Err(ServeError::NoSite { folder: folder.to_owned() }),
        }
    }

    fn add(&mut self, folder: &Path, prefix: &str, depth: usize) {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        for entry in entries {
            let (path, name) = (entry.path(), encode(&entry.file_name().to_string_lossy()));
            if path.is_file() {
                if let Ok(content) = Content::file(&path) {
                    self.files.insert(format!("{prefix}{name}"), content);
                }
            } else if path.is_dir() && depth > 0 {
                self.add(&path, &format!("{prefix}{name}/"), depth - 1);
            }
        }
    }

    pub(super) fn get(&self, path: &str) -> Option<&Content> {
        self.files.get(if path.is_empty() { "index.html" } else { path })
    }
}

/// A file name as it stands in an address: browsers write it so, whatever the user typed.
pub(super) fn encode(name: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~".contains(&byte);
    let text = |byte: u8| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") };
    name.bytes().map(text).collect()
}

fn kind(path: &Path) -> &'static str {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js" | "mjs") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("json") => "application/json",
        Some("glb") => "model/gltf-binary",
        _ => "application/octet-stream",
    }
}
