//! The binary container: a 12-byte header, then chunks (glTF 2.0, section 4 "GLB File Format").
//!
//! The JSON chunk comes first, an optional BIN chunk second. Chunks of any other type are kept as they are and
//! written back in order.

use super::error::{ReadError, WriteError};
use std::io::{self, Write};
use std::ops::Range;

/// `glTF`.
pub(super) const MAGIC: &[u8; 4] = b"glTF";
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// A chunk that glTF 2.0 does not define.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Chunk {
    /// Chunk type as in the file.
    pub(super) kind: u32,
    /// Contents, padding included.
    pub(super) bytes: Vec<u8>,
}

/// Where the parts of a GLB lie, as byte ranges of the file.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) json: Range<usize>,
    pub(super) bin: Option<Range<usize>>,
    pub(super) extra: Vec<(u32, Range<usize>)>,
}

/// Finds the chunks. Reads no further than the length in the header; a longer file is accepted (its tail is no part
/// of the asset), a shorter one is not.
pub(super) fn parse(file: &[u8]) -> Result<Layout, ReadError> {
    let broken = |offset, problem: String| ReadError::Glb { offset, problem };
    let too_short =
        || broken(file.len(), format!("the header needs {HEADER} bytes, the file has {}", file.len()));
    let version = word(file, 4).ok_or_else(too_short)?;
    if version != 2 {
        return Err(ReadError::Version { version: version.to_string() });
    }
    let declared = word(file, 8).ok_or_else(too_short)? as usize;
    let file = file.get(..declared).ok_or_else(|| {
        broken(8, format!("the header declares {declared} bytes, the file has {}", file.len()))
    })?;
    let mut layout: Option<Layout> = None;
    let mut at = HEADER;
    while at < file.len() {
        let (Some(length), Some(kind)) = (word(file, at), word(file, at + 4)) else {
            return Err(broken(at, "a chunk header is cut off".to_owned()));
        };
        let start = at + CHUNK_HEADER;
        let left = file.len() - start;
        if length as usize > left {
            return Err(broken(at, format!("a chunk declares {length} bytes, {left} are left")));
        }
        let range = start..start + length as usize;
        at = range.end;
        match &mut layout {
            None if kind == JSON => layout = Some(Layout { json: range, bin: None, extra: Vec::new() }),
            None => return Err(broken(start - CHUNK_HEADER, "the first chunk is not JSON".to_owned())),
            Some(found) if kind == BIN && found.bin.is_none() && found.extra.is_empty() => {
                found.bin = Some(range)
            }
            Some(found) => found.extra.push((kind, range)),
        }
    }
    layout.ok_or_else(|| broken(HEADER, "there is no JSON chunk".to_owned()))
}

/// Bytes of the whole file.
///
/// # Errors
/// [`WriteError::TooLarge`] from 4 GiB on: the format counts in 32 bits.
pub(super) fn length(
    json: u64,
    bin: Option<u64>,
    extra: impl Iterator<Item = u64>,
) -> Result<u32, WriteError> {
    let chunk = |bytes: u64| bytes.saturating_add(CHUNK_HEADER as u64 + 3) & !3;
    let total = extra.chain(bin).map(chunk).fold(HEADER as u64 + chunk(json), u64::saturating_add);
    u32::try_from(total).map_err(|_| WriteError::TooLarge { bytes: total })
}

/// Writes a GLB whose total `length` was computed by [`length`]. `bin` is given in parts that follow each other.
pub(super) fn write(
    out: &mut impl Write,
    length: u32,
    json: &[u8],
    bin: Option<&[&[u8]]>,
    extra: &[Chunk],
) -> io::Result<()> {
    out.write_all(MAGIC)?;
    out.write_all(&2_u32.to_le_bytes())?;
    out.write_all(&length.to_le_bytes())?;
    write_chunk(out, JSON, &[json], b' ')?;
    if let Some(parts) = bin {
        write_chunk(out, BIN, parts, 0)?;
    }
    extra.iter().try_for_each(|chunk| write_chunk(out, chunk.kind, &[&chunk.bytes], 0))
}

fn write_chunk(out: &mut impl Write, kind: u32, parts: &[&[u8]], padding: u8) -> io::Result<()> {
    let length: usize = parts.iter().map(|part| part.len()).sum();
    let padded = length.next_multiple_of(4);
    // `length()` has refused anything that does not fit.
    let field = u32::try_from(padded).map_err(|_| io::Error::other("chunk of more than 4 GiB"))?;
    out.write_all(&field.to_le_bytes())?;
    out.write_all(&kind.to_le_bytes())?;
    parts.iter().try_for_each(|part| out.write_all(part))?;
    out.write_all(&[padding; 3][..padded - length])
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(word.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(bin: Option<&[u8]>, extra: &[Chunk]) -> Vec<u8> {
        let json = b"{}";
        let lengths = extra.iter().map(|chunk| chunk.bytes.len() as u64);
        let total = length(json.len() as u64, bin.map(|bytes| bytes.len() as u64), lengths).unwrap();
        let mut file = Vec::new();
        let parts = bin.map(|bytes| [bytes]);
        write(&mut file, total, json, parts.as_ref().map(|parts| &parts[..]), extra).unwrap();
        assert_eq!(file.len(), total as usize);
        file
    }

    #[test]
    fn chunks_come_back_in_order() {
        let extra = [Chunk { kind: 7, bytes: vec![1; 4] }, Chunk { kind: BIN, bytes: vec![2; 8] }];
        let file = sample(Some(&[9; 5]), &extra);
        let layout = parse(&file).unwrap();
        assert_eq!(&file[layout.json], b"{}  ");
        assert_eq!(&file[layout.bin.unwrap()], [9, 9, 9, 9, 9, 0, 0, 0]);
        let kinds: Vec<u32> = layout.extra.iter().map(|(kind, _)| *kind).collect();
        assert_eq!(kinds, [7, BIN]);
        assert_eq!(&file[layout.extra[1].1.clone()], [2; 8]);
    }

    #[test]
    fn bin_after_an_unknown_chunk_is_kept_but_not_the_buffer() {
        let file = sample(None, &[Chunk { kind: 7, bytes: vec![] }, Chunk { kind: BIN, bytes: vec![1; 4] }]);
        let layout = parse(&file).unwrap();
        assert_eq!(layout.bin, None);
        assert_eq!(layout.extra.len(), 2);
    }

    #[test]
    fn every_cut_is_an_error_and_says_where() {
        let file = sample(Some(&[9; 8]), &[]);
        for cut in 4..file.len() {
            assert!(matches!(parse(&file[..cut]), Err(ReadError::Glb { .. })), "cut at {cut}");
        }
        let mut longer = file.clone();
        longer.extend([1, 2, 3]);
        assert_eq!(parse(&longer).unwrap(), parse(&file).unwrap(), "a tail is no part of the asset");
    }

    #[test]
    fn hostile_lengths_are_refused() {
        for (at, name) in [(8, "file"), (12, "JSON chunk"), (24, "BIN chunk")] {
            let mut file = sample(Some(&[9; 8]), &[]);
            file[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes());
            assert!(matches!(parse(&file), Err(ReadError::Glb { .. })), "{name}");
        }
        let mut file = sample(None, &[]);
        file[8] = 14;
        assert!(matches!(parse(&file), Err(ReadError::Glb { offset: 12, .. })));
        file[8] = 12;
        assert!(matches!(parse(&file), Err(ReadError::Glb { offset: 12, .. })));
        let mut file = sample(None, &[]);
        file[4] = 1;
        assert!(matches!(parse(&file), Err(ReadError::Version { .. })));
    }

    #[test]
    fn four_gibibytes_are_an_error_not_an_overflow() {
        let limit = u64::from(u32::MAX);
        assert!(length(4, Some(limit - 100), std::iter::empty()).is_ok());
        for bin in [limit - 20, limit, limit + 1, u64::MAX] {
            let result = length(4, Some(bin), std::iter::empty());
            assert!(matches!(result, Err(WriteError::TooLarge { .. })), "{bin}");
        }
        assert!(length(4, None, [limit / 2, limit / 2].into_iter()).is_err());
    }
}
