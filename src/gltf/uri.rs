//! URIs of buffers and images: `data:` URIs (RFC 2397) and percent-encoded relative paths (RFC 3986).
//!
//! A relative URI may not leave the folder of the scene, neither by `..` nor by an absolute path: a file from a
//! stranger must not be able to pull other files into the output. Symbolic links inside the folder are followed,
//! they are the user's own.

use super::error::UriError;
use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::path::{Component, Path, PathBuf};

/// Padding is optional: exporters leave it out.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// Whether the URI carries its data itself.
pub(super) fn is_data(uri: &str) -> bool {
    uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

/// The bytes of a `data:` URI.
pub(super) fn decode_data(uri: &str) -> Result<Vec<u8>, UriError> {
    let problem = |text: &str| UriError::Data { problem: text.to_owned() };
    let rest = uri.get(5..).ok_or_else(|| problem("it is empty"))?;
    let (kind, data) = rest.split_once(',').ok_or_else(|| problem("the comma before the data is missing"))?;
    let raw;
    let data = if data.contains('%') {
        raw = percent_decode(data);
        raw.as_slice()
    } else {
        data.as_bytes()
    };
    if kind.to_ascii_lowercase().ends_with(";base64") {
        BASE64.decode(data).map_err(|error| problem(&error.to_string()))
    } else {
        Ok(data.to_vec())
    }
}

/// A `data:` URI of the type that glTF asks for buffers.
pub(super) fn encode_data(bytes: &[u8]) -> String {
    let mut uri = String::from("data:application/octet-stream;base64,");
    BASE64.encode_string(bytes, &mut uri);
    uri
}

/// The URI for messages: without megabytes of it.
pub(super) fn shorten(uri: &str) -> String {
    const SHOWN: usize = 80;
    match uri.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &uri[..end]),
        None => uri.to_owned(),
    }
}

/// The path below the scene's folder that a relative URI names.
///
/// # Errors
/// [`UriError`] if the URI has a scheme, leaves the folder, or is no UTF-8 after percent-decoding.
pub(super) fn relative_path(uri: &str) -> Result<PathBuf, UriError> {
    let shown = || shorten(uri);
    if let Some((scheme, _)) = uri.split_once(':') {
        let letters = |c: char| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.');
        if scheme.len() > 1
            && scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme.chars().all(letters)
        {
            return Err(UriError::Remote { uri: shown() });
        }
    }
    let decoded = String::from_utf8(percent_decode(uri)).map_err(|_| UriError::Invalid { uri: shown() })?;
    inside(&decoded).ok_or_else(|| UriError::Outside { uri: shown() })?;
    let path = PathBuf::from(decoded);
    // `.` and an empty URI name the folder itself; a NUL can be in no file name.
    if path.file_name().is_none() || path.to_string_lossy().contains('\0') {
        return Err(UriError::Invalid { uri: shown() });
    }
    Ok(path)
}

/// The existing file that a relative URI names, below `folder`. Exporters that forget to percent-encode are
/// understood: a file whose name is the URI as it stands is taken if the decoded name does not exist.
pub(super) fn resolve(folder: &Path, uri: &str) -> Result<PathBuf, UriError> {
    let decoded = folder.join(relative_path(uri)?);
    if !decoded.exists() && uri.contains('%') && inside(uri).is_some() {
        let literal = folder.join(uri);
        if literal.exists() {
            return Ok(literal);
        }
    }
    Ok(decoded)
}

/// A file name as a relative URI.
pub(super) fn encode_path(name: &str) -> String {
    let mut uri = String::with_capacity(name.len());
    for &byte in name.as_bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'(' | b')' => {
                uri.push(char::from(byte))
            }
            // IRIs allow letters beyond ASCII, but old loaders do not: everything else is escaped.
            _ => uri.push_str(&format!("%{byte:02X}")),
        }
    }
    uri
}

/// `Some` if the path stays below its start.
fn inside(path: &str) -> Option<()> {
    // A backslash or a drive letter means something on Windows only, but files travel.
    if path.starts_with(['/', '\\']) || path.as_bytes().get(1) == Some(&b':') {
        return None;
    }
    let mut depth = 0_usize;
    for component in Path::new(&path.replace('\\', "/")).components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir => depth = depth.checked_sub(1)?,
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(())
}

/// Replaces `%41` by `A`; what is no escape stays.
fn percent_decode(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let escape = match bytes.get(at..at + 3) {
            Some([b'%', high, low]) => hex(*high).zip(hex(*low)),
            _ => None,
        };
        match escape {
            Some((high, low)) => {
                out.push(high * 16 + low);
                at += 3;
            }
            None => {
                out.push(bytes[at]);
                at += 1;
            }
        }
    }
    out
}

fn hex(digit: u8) -> Option<u8> {
    char::from(digit).to_digit(16).and_then(|value| u8::try_from(value).ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_uris_in_all_their_forms() {
        assert_eq!(decode_data("data:application/octet-stream;base64,AAEC").unwrap(), [0, 1, 2]);
        assert_eq!(decode_data("DATA:;base64,AAE").unwrap(), [0, 1], "no padding, no type");
        assert_eq!(decode_data("data:;base64,AAE%3D").unwrap(), [0, 1], "escaped padding");
        assert_eq!(decode_data("data:text/plain,a%20b").unwrap(), b"a b");
        assert!(decode_data("data:;base64,A*==").is_err());
        assert!(decode_data("data:nothing").is_err());
        assert!(!is_data("dat") && is_data("data:"));
        for length in 0..5 {
            let bytes: Vec<u8> = (0..length).collect();
            assert_eq!(decode_data(&encode_data(&bytes)).unwrap(), bytes);
        }
    }

    #[test]
    fn relative_paths_stay_inside() {
        assert_eq!(relative_path("a%20b/c.bin").unwrap(), Path::new("a b/c.bin"));
        assert_eq!(relative_path("./a/../c.bin").unwrap(), Path::new("./a/../c.bin"));
        for outside in
            ["/etc/passwd", "../x", "a/../../x", "%2e%2e/x", "%2Fetc", "\\x", "a\\..\\..\\x", "C:/x"]
        {
            assert!(matches!(relative_path(outside), Err(UriError::Outside { .. })), "{outside}");
        }
        for remote in ["http://x/y", "file:///etc/passwd", "blob:1"] {
            assert!(matches!(relative_path(remote), Err(UriError::Remote { .. })), "{remote}");
        }
        for invalid in ["", ".", "a/..", "%FF", "a%00b"] {
            assert!(matches!(relative_path(invalid), Err(UriError::Invalid { .. })), "{invalid}");
        }
    }

    #[test]
    fn names_become_uris_and_back() {
        let name = "ein schöner 100% #1 plan?.bin";
        assert_eq!(relative_path(&encode_path(name)).unwrap(), Path::new(name));
    }

    #[test]
    fn long_uris_are_shortened_on_a_character_boundary() {
        assert!(shorten(&"ö".repeat(1000)).len() < 200);
    }
}
