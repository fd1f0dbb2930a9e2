//! Loading buffers: the BIN chunk, `data:` URIs, and files beside the scene.

use super::error::{ReadError, UriError};
use super::{json, uri};
use serde_json::Value;
use std::collections::HashSet;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Where a buffer's bytes are stored.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BufferStorage {
    /// In the BIN chunk of a GLB.
    Bin,
    /// In the buffer's own `data:` URI.
    Embedded,
    /// In a file that the source document names; it is never rewritten.
    External,
    /// In a file that will be written beside the output: its name is the output's stem and this ending.
    Beside(&'static str),
    /// Nowhere: a buffer without `uri` (the fallback buffer of a compressed file). Its bytes are an empty vector.
    Absent,
}

/// Bytes that repeated mentions of one file may take: a thousand buffers that name one large file are no scene.
const REPEAT_BUDGET: u64 = 256 << 20;

/// All buffers of a document, and what is left of the BIN chunk.
#[derive(Debug, Default)]
pub(super) struct Loaded {
    pub(super) buffers: Vec<Vec<u8>>,
    pub(super) storage: Vec<BufferStorage>,
    /// The BIN chunk if no buffer claims it.
    pub(super) loose_bin: Option<Vec<u8>>,
    /// Bytes of the BIN chunk beyond the buffer's `byteLength` and its padding.
    pub(super) bin_tail: Vec<u8>,
}

/// Loads what `/buffers` names. `bin` is the BIN chunk.
pub(super) fn load(root: &Value, bin: Option<Vec<u8>>, folder: Option<&Path>) -> Result<Loaded, ReadError> {
    let mut loaded = Loaded { loose_bin: bin, ..Loaded::default() };
    let mut seen = HashSet::new();
    let mut repeats = REPEAT_BUDGET;
    for (i, buffer) in json::array(root, "buffers").iter().enumerate() {
        let pointer = format!("/buffers/{i}");
        let length = buffer.get("byteLength").and_then(json::index).ok_or_else(|| ReadError::Malformed {
            pointer: format!("{pointer}/byteLength"),
            expected: "a non-negative integer",
        })?;
        let (bytes, storage) = match buffer.get("uri") {
            None => match loaded.loose_bin.take_if(|bin| i == 0 && !is_fallback(buffer, length, bin.len())) {
                Some(mut bin) => {
                    check_length(&pointer, length, bin.len() as u64)?;
                    if bin.len() - length > 3 {
                        loaded.bin_tail = bin.split_off(length);
                    }
                    bin.truncate(length);
                    (bin, BufferStorage::Bin)
                }
                None => (Vec::new(), BufferStorage::Absent),
            },
            Some(Value::String(text)) if uri::is_data(text) => {
                let mut bytes = uri::decode_data(text)
                    .map_err(|problem| ReadError::Uri { pointer: format!("{pointer}/uri"), problem })?;
                check_length(&pointer, length, bytes.len() as u64)?;
                bytes.truncate(length);
                (bytes, BufferStorage::Embedded)
            }
            Some(Value::String(text)) => {
                let path = locate(folder, text)
                    .map_err(|problem| ReadError::Uri { pointer: format!("{pointer}/uri"), problem })?;
                if !seen.insert(path.clone()) {
                    repeats = repeats
                        .checked_sub(length as u64)
                        .ok_or_else(|| ReadError::RepeatedBuffer { pointer: pointer.clone() })?;
                }
                (read_exactly(&path, &pointer, length)?, BufferStorage::External)
            }
            Some(_) => {
                return Err(ReadError::Malformed { pointer: format!("{pointer}/uri"), expected: "a string" });
            }
        };
        loaded.buffers.push(bytes);
        loaded.storage.push(storage);
    }
    Ok(loaded)
}

/// The file a relative URI names.
pub(super) fn locate(folder: Option<&Path>, text: &str) -> Result<PathBuf, UriError> {
    match folder {
        Some(folder) => uri::resolve(folder, text),
        None => {
            // A URI that is wrong anyway is reported as such.
            uri::relative_path(text)?;
            Err(UriError::NoFolder { uri: uri::shorten(text) })
        }
    }
}

/// EXT_meshopt_compression: a buffer that exists for its length only.
fn is_fallback(buffer: &Value, length: usize, bin: usize) -> bool {
    let marked = |extension: &Value| extension.get("fallback") == Some(&Value::Bool(true));
    length > bin
        && buffer.get("extensions").and_then(Value::as_object).is_some_and(|all| all.values().any(marked))
}

fn check_length(pointer: &str, needed: usize, available: u64) -> Result<(), ReadError> {
    let needed = needed as u64;
    if needed > available {
        return Err(ReadError::BufferTooShort { pointer: pointer.to_owned(), needed, available });
    }
    Ok(())
}

/// Reads the first `length` bytes; the file's size is checked before anything is allocated.
fn read_exactly(path: &Path, pointer: &str, length: usize) -> Result<Vec<u8>, ReadError> {
    let io = |source| ReadError::Io { path: path.to_owned(), source };
    let available = file_length(path).map_err(io)?;
    check_length(pointer, length, available)?;
    let mut bytes = Vec::with_capacity(length);
    let file = std::fs::File::open(path).map_err(io)?;
    file.take(length as u64).read_to_end(&mut bytes).map_err(io)?;
    check_length(pointer, length, bytes.len() as u64)?;
    Ok(bytes)
}

/// Bytes of a regular file; anything else (a pipe could block for ever) is an error.
pub(super) fn file_length(path: &Path) -> std::io::Result<u64> {
    let metadata = std::fs::metadata(path)?;
    if !metadata.is_file() {
        return Err(std::io::Error::other("it is not a regular file"));
    }
    Ok(metadata.len())
}
