//! A glTF document in memory: its JSON as it is, its buffers as bytes, and how both were stored.

use super::buffers::{self, BufferStorage};
use super::compressed::Decoded;
use super::error::{AccessorError, ReadError, UriError};
use super::glb::{self, Chunk};
use super::style::JsonStyle;
use super::{json, uri};
use serde_json::Value;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// How a document is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Container {
    /// One binary file (`.glb`).
    Glb,
    /// JSON text (`.gltf`) with buffers in files beside it or in `data:` URIs.
    Gltf,
}

impl Container {
    /// The container that a file name asks for; `None` if its extension is neither `.glb` nor `.gltf`.
    pub fn from_path(path: &Path) -> Option<Container> {
        let extension = path.extension()?;
        if extension.eq_ignore_ascii_case("glb") {
            Some(Container::Glb)
        } else if extension.eq_ignore_ascii_case("gltf") {
            Some(Container::Gltf)
        } else {
            None
        }
    }
}

/// A glTF 2.0 document.
///
/// `json` and `buffers` may be edited; [`Document::write`] checks that they still fit together.
#[derive(Clone, Debug)]
pub struct Document {
    /// The whole JSON, an object. Key order and number text are those of the file.
    ///
    /// Compressed buffer views are those that were there when the document was made, or attached to it since.
    pub json: Value,
    /// The bytes of `/buffers/N`, `byteLength` of them; empty for a buffer without data.
    pub buffers: Vec<Vec<u8>>,
    pub(super) storage: Vec<BufferStorage>,
    pub(super) container: Container,
    pub(super) folder: Option<PathBuf>,
    pub(super) extra_chunks: Vec<Chunk>,
    pub(super) loose_bin: Option<Vec<u8>>,
    pub(super) bin_tail: Vec<u8>,
    pub(super) style: JsonStyle,
    pub(super) dropped_chunks: usize,
    /// Bytes of all buffers when the document was read: what its accessors may plausibly stand for.
    pub(super) read_bytes: u64,
    pub(super) decoded: Decoded,
}

impl Document {
    /// Reads a `.glb` (recognised by its first bytes, not its name) or `.gltf` file and all its buffers.
    ///
    /// Buffers in other files are found relative to the file's folder and may not lie outside it.
    ///
    /// # Errors
    /// [`ReadError`] if a file is missing, is not glTF 2.x, or contradicts itself.
    pub fn read(path: &Path) -> Result<Document, ReadError> {
        let io = |source| ReadError::Io { path: path.to_owned(), source };
        let file = std::fs::read(path).map_err(io)?;
        // Of a bare file name the folder is the current one.
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        Self::from_vec(file, Some(folder))
    }

    /// Reads a GLB from memory. Buffers in other files are refused: there is no folder to find them in.
    ///
    /// # Errors
    /// As [`Document::read`].
    pub fn from_glb(bytes: &[u8]) -> Result<Document, ReadError> {
        Self::from_vec(bytes.to_vec(), None)
    }

    /// Reads a GLB or glTF JSON from memory; `folder` is where relative URIs start, `None` refuses them.
    ///
    /// # Errors
    /// As [`Document::read`].
    pub fn from_slice(bytes: &[u8], folder: Option<&Path>) -> Result<Document, ReadError> {
        Self::from_vec(bytes.to_vec(), folder.map(Path::to_owned))
    }

    /// Makes a GLB document from JSON and the bytes of buffer 0.
    ///
    /// # Errors
    /// [`ReadError`] if the JSON is no glTF 2.x, or its first buffer is longer than `bin`.
    pub fn from_parts(json: Value, bin: Option<Vec<u8>>) -> Result<Document, ReadError> {
        Self::assemble(json, Container::Glb, bin, Vec::new(), None, JsonStyle::default())
    }

    fn from_vec(mut file: Vec<u8>, folder: Option<PathBuf>) -> Result<Document, ReadError> {
        if !file.starts_with(glb::MAGIC) {
            let text = file.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&file);
            require_json_start(text)?;
            let json = serde_json::from_slice(text)?;
            let style = JsonStyle::detect(text);
            return Self::assemble(json, Container::Gltf, None, Vec::new(), folder, style);
        }
        let layout = glb::parse(&file)?;
        let text = &file[layout.json];
        // The standard pads with spaces; some exporters pad with zeros.
        let end = text.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
        let text = text[..end].strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&text[..end]);
        let json = serde_json::from_slice(text)?;
        let extra = layout.extra.into_iter();
        let extra = extra.map(|(kind, range)| Chunk { kind, bytes: file[range].to_vec() }).collect();
        // The BIN chunk is most of the file: it is cut out in place.
        let bin = layout.bin.map(|range| {
            file.truncate(range.end);
            file.drain(..range.start);
            file
        });
        Self::assemble(json, Container::Glb, bin, extra, folder, JsonStyle::default())
    }

    fn assemble(
        json: Value,
        container: Container,
        bin: Option<Vec<u8>>,
        extra_chunks: Vec<Chunk>,
        folder: Option<PathBuf>,
        style: JsonStyle,
    ) -> Result<Document, ReadError> {
        require_gltf(&json)?;
        let loaded = buffers::load(&json, bin, folder.as_deref())?;
        let read_bytes = loaded.buffers.iter().map(|buffer| buffer.len() as u64).sum();
        let decoded = Decoded::new(&json, &loaded.storage, read_bytes);
        Ok(Document {
            json,
            buffers: loaded.buffers,
            storage: loaded.storage,
            container,
            folder,
            extra_chunks,
            loose_bin: loaded.loose_bin,
            bin_tail: loaded.bin_tail,
            style,
            dropped_chunks: 0,
            read_bytes,
            decoded,
        })
    }

    /// How the document is stored.
    pub fn container(&self) -> Container {
        self.container
    }

    /// Where relative URIs start; `None` for a document from memory.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// How buffer `index` is stored; `None` if there is no such buffer.
    pub fn buffer_storage(&self, index: usize) -> Option<&BufferStorage> {
        self.storage.get(index)
    }

    /// Bytes of all buffers.
    pub fn buffer_bytes(&self) -> u64 {
        self.buffers.iter().map(|buffer| buffer.len() as u64).sum()
    }

    /// Bytes of all buffers, and of what is compressed in them as it is decompressed: the bound on what accessors with data
    /// can describe.
    pub fn described_bytes(&self) -> u64 {
        self.buffer_bytes().saturating_add(self.decoded.described())
    }

    /// Whether the only copy of some buffer view is compressed (`EXT_meshopt_compression`, `KHR_meshopt_compression`).
    pub fn has_compressed_views(&self) -> bool {
        !self.decoded.is_empty()
    }

    /// To be called after buffer views were added or removed.
    pub(super) fn views_changed(&mut self) {
        self.decoded = Decoded::new(&self.json, &self.storage, self.buffer_bytes());
    }

    /// Number of accessors, which is the index that the next appended accessor gets.
    pub fn next_accessor(&self) -> usize {
        json::array(&self.json, "accessors").len()
    }

    /// The bytes of a buffer view. If they are stored compressed only, they are decoded when they are first asked for, and
    /// kept.
    ///
    /// # Errors
    /// [`AccessorError`] if the view or its buffer does not exist, has no data, or the view leaves its buffer; if it is
    /// compressed, and the data are broken or this build (without the feature `bake`) has no decoder.
    pub fn buffer_view(&self, index: usize) -> Result<&[u8], AccessorError> {
        if self.decoded.has(index) { self.decoded.view(self, index) } else { self.stored_view(index) }
    }

    /// The bytes of a buffer view as they are stored.
    fn stored_view(&self, index: usize) -> Result<&[u8], AccessorError> {
        let pointer = format!("/bufferViews/{index}");
        match json::array(&self.json, "bufferViews").get(index) {
            Some(view) => self.stored_bytes(view, &pointer),
            None => Err(AccessorError::Missing { pointer }),
        }
    }

    /// The range of a buffer that an object at `pointer` names: a buffer view, or the extension on one.
    pub(super) fn stored_bytes(&self, view: &Value, pointer: &str) -> Result<&[u8], AccessorError> {
        let number = |key: &str, default: Option<usize>| match view.get(key) {
            None => default,
            Some(value) => json::index(value),
        };
        let required = |key: &str, default| {
            number(key, default).ok_or_else(|| AccessorError::Malformed {
                pointer: format!("{pointer}/{key}"),
                expected: "a non-negative integer",
            })
        };
        let buffer = required("buffer", None)?;
        let (offset, length) = (required("byteOffset", Some(0))?, required("byteLength", None)?);
        let buffer_pointer = || format!("/buffers/{buffer}");
        let bytes =
            self.buffers.get(buffer).ok_or_else(|| AccessorError::Missing { pointer: buffer_pointer() })?;
        if self.storage.get(buffer) == Some(&BufferStorage::Absent) {
            return Err(AccessorError::NoData { pointer: buffer_pointer() });
        }
        let end = offset.checked_add(length);
        end.and_then(|end| bytes.get(offset..end)).ok_or_else(|| AccessorError::OutOfBounds {
            pointer: pointer.to_owned(),
            needed: (offset as u64).saturating_add(length as u64),
            available: bytes.len() as u64,
        })
    }

    /// Where a buffer view lies: its buffer, and a range of it.
    ///
    /// # Errors
    /// As [`Self::buffer_view`]; and if the view is stored compressed only.
    pub fn buffer_view_range(&self, index: usize) -> Result<(usize, std::ops::Range<usize>), AccessorError> {
        // Checks everything.
        let length = self.stored_view(index)?.len();
        let view = &json::array(&self.json, "bufferViews")[index];
        let number = |key: &str| view.get(key).and_then(json::index).unwrap_or(0);
        let start = number("byteOffset");
        Ok((number("buffer"), start..start + length))
    }

    /// The bytes behind a URI of this document (an image, say): a `data:` URI or a file in the document's folder.
    /// More than `limit` bytes are refused before they are read.
    ///
    /// # Errors
    /// [`ReadError`] at `pointer` if the URI cannot be followed or the file cannot be read.
    pub fn read_uri(&self, text: &str, pointer: &str, limit: u64) -> Result<Cow<'_, [u8]>, ReadError> {
        let refuse = |problem| ReadError::Uri { pointer: pointer.to_owned(), problem };
        let too_large = |bytes| refuse(UriError::TooLarge { uri: uri::shorten(text), bytes, limit });
        if uri::is_data(text) {
            if text.len() as u64 / 4 * 3 > limit.saturating_add(256) {
                return Err(too_large(text.len() as u64 / 4 * 3));
            }
            return Ok(Cow::Owned(uri::decode_data(text).map_err(refuse)?));
        }
        let path = buffers::locate(self.folder.as_deref(), text).map_err(refuse)?;
        let io = |source| ReadError::Io { path: path.clone(), source };
        let bytes = buffers::file_length(&path).map_err(io)?;
        if bytes > limit {
            return Err(too_large(bytes));
        }
        Ok(Cow::Owned(std::fs::read(&path).map_err(io)?))
    }
}

/// Refuses what is obviously something else, with a guess at what it is.
fn require_json_start(text: &[u8]) -> Result<(), ReadError> {
    let found = match text.iter().find(|byte| !byte.is_ascii_whitespace()) {
        Some(b'{') => return Ok(()),
        None => "it is empty",
        Some(_) if text.starts_with(b"PK\x03\x04") => "it is a zip archive (unpack it first)",
        Some(_) if text.starts_with(&[0x1F, 0x8B]) => "it is gzip-compressed (unpack it first)",
        Some(_) if text.starts_with(b"Kaydara FBX") => "it is an FBX file",
        Some(_) if text.starts_with(&[0xFF, 0xFE]) || text.starts_with(&[0xFE, 0xFF]) => {
            "it is UTF-16 text (glTF JSON must be UTF-8)"
        }
        Some(_) => "it begins neither with \"glTF\" nor with a JSON object",
    };
    Err(ReadError::NotGltf { found: found.to_owned() })
}

/// The root is an object with `asset.version` 2.x, and the arrays this crate works on are arrays.
fn require_gltf(root: &Value) -> Result<(), ReadError> {
    let not_gltf = |found: &str| ReadError::NotGltf { found: found.to_owned() };
    if !root.is_object() {
        return Err(not_gltf("its JSON is not an object"));
    }
    let asset = root.get("asset").ok_or_else(|| not_gltf("its JSON has no \"asset\" property"))?;
    match asset.get("version") {
        Some(Value::String(version)) if version == "2" || version.starts_with("2.") => {}
        Some(Value::String(version)) => return Err(ReadError::Version { version: uri::shorten(version) }),
        _ => {
            return Err(ReadError::Malformed {
                pointer: "/asset/version".into(),
                expected: "the string \"2.0\"",
            });
        }
    }
    for key in ["buffers", "bufferViews", "accessors", "extensionsUsed"] {
        if root.get(key).is_some_and(|value| !value.is_array()) {
            return Err(ReadError::Malformed { pointer: format!("/{key}"), expected: "an array" });
        }
    }
    for key in ["buffers", "bufferViews", "accessors"] {
        if let Some(at) = json::array(root, key).iter().position(|item| !item.is_object()) {
            return Err(ReadError::Malformed { pointer: format!("/{key}/{at}"), expected: "an object" });
        }
    }
    if root.get("extensions").is_some_and(|value| !value.is_object()) {
        return Err(ReadError::Malformed { pointer: "/extensions".into(), expected: "an object" });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn read(text: &str) -> Result<Document, ReadError> {
        Document::from_slice(text.as_bytes(), None)
    }

    #[test]
    fn what_is_not_gltf_gets_a_clear_error() {
        for (text, expected) in [
            ("", "empty"),
            ("o object\nv 1 2 3", "neither"),
            ("PK\x03\x04zip", "zip"),
            ("[1]", "neither"),
            ("{}", "asset"),
            ("{\"asset\":{\"version\":\"1.0\"}}", "version 1.0"),
            ("{\"asset\":{}}", "/asset/version"),
            ("{\"asset\":{\"version\":\"2.0\"},\"accessors\":{}}", "/accessors"),
            ("{\"asset\":{\"version\":\"2.0\"},\"accessors\":[3]}", "/accessors/0"),
            ("{\"asset\":{\"version\":\"2.0\"},\"extensions\":[]}", "/extensions"),
            ("{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{}]}", "/buffers/0/byteLength"),
            ("{\"asset\":{\"version\":\"2.0\"}", "cannot be parsed"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(expected), "{text:?}: {message}");
        }
    }

    #[test]
    fn a_byte_order_mark_is_skipped() {
        let document = read("\u{FEFF}{\"asset\":{\"version\":\"2.0\"}}").unwrap();
        assert_eq!(document.container(), Container::Gltf);
    }

    #[test]
    fn deep_nesting_is_an_error_not_a_stack_overflow() {
        let deep = format!("{{\"asset\":{{\"version\":\"2.0\"}},\"extras\":{}", "[".repeat(1_000_000));
        assert!(matches!(read(&deep), Err(ReadError::Json { .. })));
    }

    #[test]
    fn number_text_and_key_order_survive() {
        let text =
            "{\"z\":1.0,\"asset\":{\"version\":\"2.0\"},\"a\":[1e-7,2e+5,-0.0,0.1000,123456789012345678901]}";
        assert_eq!(serde_json::to_string(&read(text).unwrap().json).unwrap(), text);
        // The one thing that changes: exponents get a small e and a sign.
        let written = text.replace("2e+5", "2E5");
        assert_eq!(serde_json::to_string(&read(&written).unwrap().json).unwrap(), text);
    }

    #[test]
    fn data_uris_are_loaded_and_lengths_checked() {
        let document = |length: u64| {
            let buffer = json!({"byteLength": length, "uri": "data:;base64,AAECAw=="});
            read(&json!({"asset": {"version": "2.0"}, "buffers": [buffer]}).to_string())
        };
        assert_eq!(document(3).unwrap().buffers, [vec![0, 1, 2]]);
        assert!(matches!(document(5), Err(ReadError::BufferTooShort { needed: 5, available: 4, .. })));
        assert!(matches!(document(u64::MAX), Err(ReadError::BufferTooShort { .. })));
    }

    #[test]
    fn files_outside_the_folder_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for uri in ["../secret.bin", "/etc/passwd", "http://example.org/a.bin"] {
            let text =
                json!({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 1, "uri": uri}]}).to_string();
            let result = Document::from_slice(text.as_bytes(), Some(folder.path()));
            assert!(matches!(result, Err(ReadError::Uri { .. })), "{uri}");
            assert!(matches!(read(&text), Err(ReadError::Uri { .. })), "{uri} without folder");
        }
    }

    #[test]
    fn one_file_named_by_many_buffers_cannot_exhaust_memory() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::File::create(folder.path().join("a.bin")).unwrap().set_len(200 << 20).unwrap();
        let buffer = json!({"byteLength": 100 << 20, "uri": "a.bin"});
        let text = json!({"asset": {"version": "2.0"}, "buffers": vec![buffer; 5]}).to_string();
        let result = Document::from_slice(text.as_bytes(), Some(folder.path()));
        assert!(matches!(result, Err(ReadError::RepeatedBuffer { .. })));
    }

    #[test]
    fn a_fallback_buffer_has_no_bytes() {
        let fallback = json!({"byteLength": 1_000_000_000_000_u64,
            "extensions": {"EXT_meshopt_compression": {"fallback": true}}});
        let json = json!({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 2}, fallback],
            "bufferViews": [{"buffer": 1, "byteLength": 4}]});
        let document = Document::from_parts(json, Some(vec![1, 2])).unwrap();
        assert_eq!(document.buffer_storage(1), Some(&BufferStorage::Absent));
        assert!(document.buffers[1].is_empty());
        assert!(matches!(document.buffer_view(0), Err(AccessorError::NoData { .. })));
    }

    #[test]
    fn buffer_views_are_checked() {
        let views = json!([{"buffer": 0, "byteOffset": 1, "byteLength": 2}, {"buffer": 0, "byteLength": 4},
            {"buffer": 9, "byteLength": 1}, {"byteLength": 1}, {"buffer": 0, "byteOffset": -1, "byteLength": 1},
            {"buffer": 0, "byteOffset": u64::MAX, "byteLength": u64::MAX}]);
        let json = json!({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 3}], "bufferViews": views});
        let document = Document::from_parts(json, Some(vec![5, 6, 7])).unwrap();
        assert_eq!(document.buffer_view(0).unwrap(), [6, 7]);
        for index in 1..7 {
            assert!(document.buffer_view(index).is_err(), "{index}");
        }
    }

    #[test]
    fn images_by_uri_have_a_limit() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a b.png"), [1, 2, 3]).unwrap();
        let text = "{\"asset\":{\"version\":\"2.0\"}}";
        let document = Document::from_slice(text.as_bytes(), Some(folder.path())).unwrap();
        assert_eq!(&*document.read_uri("a%20b.png", "/images/0/uri", 3).unwrap(), [1, 2, 3]);
        assert_eq!(&*document.read_uri("data:,abc", "/images/0/uri", 3).unwrap(), b"abc");
        assert!(document.read_uri("a%20b.png", "/images/0/uri", 2).is_err());
        assert!(document.read_uri("../a", "/images/0/uri", 2).is_err());
    }
}
