//! Files that a document names beside itself, and which of them a copy of the document needs.

use super::document::Document;
use super::error::UriError;
use super::uri;
use serde_json::Value;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// A file to copy.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Copy {
    pub(super) from: PathBuf,
    /// Relative to the folder of the output.
    pub(super) to: PathBuf,
}

/// What the document's relative URIs name.
#[derive(Debug, Default)]
pub(super) struct Resources {
    /// Files that exist in the document's folder.
    pub(super) files: Vec<(String, Copy)>,
    /// Relative URIs that name no file, or none that may be copied.
    pub(super) unresolved: Vec<String>,
}

impl Document {
    /// All relative URIs of the JSON, each once, in document order: any property called `uri`, so that images,
    /// buffers and resources of unknown extensions are all found.
    pub(super) fn resources(&self) -> Resources {
        let mut found = Resources::default();
        let mut seen = HashSet::new();
        let mut stack = vec![&self.json];
        while let Some(value) = stack.pop() {
            match value {
                Value::Array(items) => stack.extend(items.iter().rev()),
                Value::Object(items) => {
                    stack.extend(items.values().rev());
                    if let Some(Value::String(text)) = items.get("uri")
                        && !uri::is_data(text)
                        && seen.insert(text)
                    {
                        found.add(text, self.folder.as_deref());
                    }
                }
                _ => {}
            }
        }
        found
    }
}

impl Resources {
    fn add(&mut self, text: &str, folder: Option<&Path>) {
        let path = match (uri::relative_path(text), folder) {
            // What is on the web needs no copy.
            (Err(UriError::Remote { .. }), _) => return,
            (Ok(_), Some(folder)) => uri::resolve(folder, text).ok(),
            _ => None,
        };
        let copy = path.filter(|path| path.is_file()).and_then(|from| {
            let to = from.strip_prefix(folder?).ok()?.to_owned();
            Some(Copy { from, to })
        });
        match copy {
            Some(copy) => self.files.push((text.to_owned(), copy)),
            None => self.unresolved.push(text.to_owned()),
        }
    }
}
