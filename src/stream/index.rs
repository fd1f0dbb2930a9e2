//! The compressed copy of the JSON at the begin of the BIN chunk.
//!
//! It is the first buffer view's worth of bytes of an arranged file: 16 bytes of header (the letters `SVSJ`, the version 1,
//! the number of compressed bytes and that of the JSON text, each 32 bits, little-endian), then a zlib stream (RFC 1950) of the text.
//! A copy that does not agree with the JSON chunk is ignored, so a tool that changes the file and keeps the copy does no harm.

use flate2::read::ZlibDecoder;
use std::io::Read;

const MAGIC: &[u8; 4] = b"SVSJ";
const VERSION: u32 = 1;
/// Bytes of the header.
pub(super) const HEADER: usize = 16;
/// Name of the buffer view.
#[cfg(feature = "bake")]
pub(super) const NAME: &str = "compressed JSON for streaming";

/// What the header says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Header {
    /// Compressed bytes after the header.
    pub(super) packed: u32,
    /// Bytes of the text.
    pub(super) text: u32,
}

impl Header {
    /// Reads a header; `None` if there is none.
    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
        (bytes.get(..4)? == MAGIC && word(4)? == VERSION)
            .then_some(())
            .and_then(|()| Some(Self { packed: word(8)?, text: word(12)? }))
    }
}

/// The text of a compressed copy, if it has the stated length and begins with `begin`.
pub(super) fn unpack(header: Header, packed: &[u8], begin: &[u8]) -> Option<Vec<u8>> {
    let packed = packed.get(..header.packed as usize)?;
    let mut text = Vec::new();
    // A little more than stated, to see that there is no more; what is stated was checked against the file's length.
    let mut decoder = ZlibDecoder::new(packed).take(u64::from(header.text) + 1);
    decoder.read_to_end(&mut text).ok()?;
    (text.len() == header.text as usize && text.starts_with(begin)).then_some(text)
}

/// A copy of a text, without padding.
#[cfg(feature = "bake")]
pub(super) fn pack(text: &[u8]) -> std::io::Result<Vec<u8>> {
    use std::io::Write;
    let mut bytes = vec![0; HEADER];
    let mut encoder = flate2::write::ZlibEncoder::new(&mut bytes, flate2::Compression::best());
    encoder.write_all(text)?;
    encoder.finish()?;
    let word = |length: usize| u32::try_from(length).map_err(std::io::Error::other);
    let (packed, text) = (word(bytes.len() - HEADER)?, word(text.len())?);
    for (at, word) in [u32::from_le_bytes(*MAGIC), VERSION, packed, text].into_iter().enumerate() {
        bytes[at * 4..at * 4 + 4].copy_from_slice(&word.to_le_bytes());
    }
    Ok(bytes)
}

#[cfg(all(test, feature = "bake"))]
mod tests {
    use super::*;

    #[test]
    fn copies_come_back_and_wrong_ones_do_not() {
        let text = b"{\"asset\":{\"version\":\"2.0\"}}".repeat(50);
        let bytes = pack(&text).unwrap();
        let header = Header::read(&bytes).unwrap();
        assert_eq!(header.text as usize, text.len());
        assert_eq!(unpack(header, &bytes[HEADER..], &text[..40]), Some(text.clone()));
        assert_eq!(unpack(header, &bytes[HEADER..], b"{\"other"), None);
        assert_eq!(unpack(header, &bytes[HEADER..bytes.len() - 1], b""), None);
        for wrong in [header.text - 1, header.text + 1, 0] {
            assert_eq!(unpack(Header { text: wrong, ..header }, &bytes[HEADER..], b""), None);
        }
        assert_eq!(Header::read(b"SVSJ"), None);
        assert_eq!(Header::read(&[0; 16]), None);
    }
}
