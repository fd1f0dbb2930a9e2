//! The begin of a file: everything until its JSON is known.

use super::StreamError;
use super::index::{self, Header};
use super::ranges::Ranges;
use crate::gltf::{Document, ReadError};
use std::ops::Range;

/// Bytes from the begin of a file that hold the header and the name and length of its first chunk.
const PREFIX: u64 = 20;
const CHUNK_HEADER: u64 = 8;
/// Longer JSON is looked for in compressed form first.
const LONG: u64 = 128 << 10;
/// How much smaller the compressed copy is guessed to be; what is missing then is fetched with one more request.
const RATIO: u64 = 8;

/// A file of which only the begin is known.
#[derive(Debug)]
pub struct Head {
    length: u64,
    /// Bytes of the JSON chunk.
    json: u64,
    parts: Vec<(u64, Vec<u8>)>,
    have: Ranges,
    asked: Ranges,
    step: Step,
}

/// What is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// The compressed copy.
    Index,
    /// The JSON chunk itself.
    Json,
}

impl Head {
    /// Looks at the first bytes of a file of `length` bytes; `None` if it is no GLB with a JSON and a BIN chunk, or too short
    /// to be worth it: load it as a whole then.
    pub fn new(length: u64, first: &[u8]) -> Option<Self> {
        let word = |at: usize| Some(u32::from_le_bytes(first.get(at..at + 4)?.try_into().ok()?));
        let is_glb = first.starts_with(b"glTF") && word(4)? == 2 && first.get(16..20)? == b"JSON";
        let json = u64::from(word(12)?);
        let has_bin = PREFIX + json + CHUNK_HEADER < length && u64::from(word(8)?) <= length;
        if !is_glb || !has_bin || first.len() as u64 >= length {
            return None;
        }
        let step = if json > LONG { Step::Index } else { Step::Json };
        let mut head =
            Self { length, json, parts: Vec::new(), have: Ranges::default(), asked: Ranges::default(), step };
        head.store(0, first);
        Some(head)
    }

    /// Bytes of the file.
    pub fn length(&self) -> u64 {
        self.length
    }

    fn store(&mut self, at: u64, bytes: &[u8]) {
        self.have.insert(at..at + bytes.len() as u64);
        self.parts.push((at, bytes.to_vec()));
    }

    fn bin(&self) -> u64 {
        PREFIX + self.json + CHUNK_HEADER
    }

    /// What is needed in the present step.
    fn needed(&self) -> Range<u64> {
        match self.step {
            Step::Json => 0..self.bin(),
            Step::Index => {
                let begin = self.bin() - CHUNK_HEADER;
                let guess = self.bin() + index::HEADER as u64 + self.json / RATIO;
                let end = self.index().map_or(guess, |header| self.index_end(header));
                begin..end.min(self.length)
            }
        }
    }

    fn index_end(&self, header: Header) -> u64 {
        self.bin() + index::HEADER as u64 + u64::from(header.packed)
    }

    /// Header of the compressed copy, if it is there already and plausible.
    fn index(&self) -> Option<Header> {
        let header = Header::read(&self.read(self.bin()..self.bin() + index::HEADER as u64)?)?;
        let fits = self.index_end(header) <= self.length
            && u64::from(header.text) <= self.json
            && u64::from(header.text) + 3 >= self.json;
        fits.then_some(header)
    }

    fn read(&self, range: Range<u64>) -> Option<Vec<u8>> {
        if !self.have.contains(&range) || range.end > self.length {
            return None;
        }
        let mut bytes = vec![0; (range.end - range.start) as usize];
        for (at, part) in &self.parts {
            let (from, to) = (range.start.max(*at), range.end.min(at + part.len() as u64));
            if from < to {
                bytes[(from - range.start) as usize..(to - range.start) as usize]
                    .copy_from_slice(&part[(from - at) as usize..(to - at) as usize]);
            }
        }
        Some(bytes)
    }

    /// What to fetch now; empty while something is on its way.
    pub fn wanted(&mut self) -> Vec<Range<u64>> {
        let wanted: Vec<Range<u64>> = self
            .have
            .missing(self.needed())
            .into_iter()
            .filter(|range| !self.asked.contains(range))
            .collect();
        wanted.iter().for_each(|range| self.asked.insert(range.clone()));
        wanted
    }

    /// Takes bytes; once the JSON is known, the document, with zeros where bytes are missing, and all bytes so far.
    ///
    /// # Errors
    /// [`StreamError`] for bytes outside the file, and if the file is broken.
    pub fn receive(&mut self, at: u64, bytes: &[u8]) -> Result<Option<Known>, StreamError> {
        let end = at.saturating_add(bytes.len() as u64);
        if end > self.length {
            return Err(StreamError::Outside { start: at, end, length: self.length });
        }
        self.store(at, bytes);
        self.known()
    }

    /// The document, if its JSON is known already.
    ///
    /// # Errors
    /// As [`Self::receive`].
    pub fn known(&mut self) -> Result<Option<Known>, StreamError> {
        if !self.have.contains(&self.needed()) {
            return Ok(None);
        }
        if self.step == Step::Index {
            if let Some(header) = self.index() {
                // There may be more to fetch than was guessed.
                let Some(packed) = self.read(self.bin() + index::HEADER as u64..self.index_end(header))
                else {
                    return Ok(None);
                };
                let known = self
                    .have
                    .missing(0..PREFIX + self.json)
                    .first()
                    .map_or(self.json, |gap| gap.start - PREFIX);
                let begin = self.read(PREFIX..PREFIX + known.min(u64::from(header.text))).unwrap_or_default();
                if let Some(text) = index::unpack(header, &packed, &begin) {
                    return self.document(&text).map(Some);
                }
            }
            self.step = Step::Json;
            return self.known();
        }
        let Some(text) = self.read(PREFIX..PREFIX + self.json) else { return Ok(None) };
        self.document(&text).map(Some)
    }

    fn document(&mut self, text: &[u8]) -> Result<Known, StreamError> {
        let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
        let end = text.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
        let json = serde_json::from_slice(&text[..end]).map_err(ReadError::from)?;
        let start = self.bin();
        let chunk = self.read(start - CHUNK_HEADER..start).unwrap_or_default();
        let broken = |problem: &str| ReadError::Glb {
            offset: (start - CHUNK_HEADER) as usize,
            problem: problem.to_owned(),
        };
        if chunk.get(4..8) != Some(b"BIN\0".as_slice()) {
            return Err(broken("the second chunk is not BIN").into());
        }
        let stated = chunk.get(..4).and_then(|word| word.try_into().ok()).map_or(0, u32::from_le_bytes);
        let length = u64::from(stated);
        if start + length > self.length {
            return Err(broken("the BIN chunk is longer than the file").into());
        }
        let memory = StreamError::Memory { bytes: self.length };
        let mut bin = Vec::new();
        let Ok(size) = usize::try_from(length) else { return Err(memory) };
        if bin.try_reserve_exact(size).is_err() {
            return Err(memory);
        }
        bin.resize(size, 0);
        let document = Document::from_parts(json, Some(bin))?;
        Ok(Known { document, bin: start, length: self.length, parts: std::mem::take(&mut self.parts) })
    }
}

/// A file whose JSON is known.
#[derive(Debug)]
pub struct Known {
    pub(super) document: Document,
    /// Where the BIN chunk's data begin in the file.
    pub(super) bin: u64,
    pub(super) length: u64,
    pub(super) parts: Vec<(u64, Vec<u8>)>,
}
