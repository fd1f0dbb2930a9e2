//! Streams of `EXT_meshopt_compression` and `KHR_meshopt_compression`, read and written with the library whose format
//! they are.

use super::error::AccessorError;
use super::json;
use serde_json::Value;

/// What a stream is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Attributes(Filter),
    Triangles,
    Indices,
}

/// What is done to attributes after decoding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Filter {
    None,
    Octahedral,
    Quaternion,
    Exponential,
    /// Of `KHR_meshopt_compression` alone.
    Color,
}

/// The properties of the extension on a buffer view, checked: decoding cannot ask for what the codecs do not have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stream {
    mode: Mode,
    /// Elements.
    count: usize,
    /// Bytes of an element.
    pub(super) stride: usize,
}

impl Stream {
    /// Reads the extension's object, which is at `pointer`.
    pub(super) fn read(extension: &Value, pointer: &str) -> Result<Self, AccessorError> {
        let wrong =
            |key: &str, expected| AccessorError::Malformed { pointer: format!("{pointer}/{key}"), expected };
        let number = |key: &str| {
            let value = extension.get(key).and_then(json::index);
            value.ok_or_else(|| wrong(key, "a non-negative integer"))
        };
        let (count, stride) = (number("count")?, number("byteStride")?);
        let filter = match extension.get("filter").map(Value::as_str) {
            None | Some(Some("NONE")) => Filter::None,
            Some(Some("OCTAHEDRAL")) => Filter::Octahedral,
            Some(Some("QUATERNION")) => Filter::Quaternion,
            Some(Some("EXPONENTIAL")) => Filter::Exponential,
            Some(Some("COLOR")) => Filter::Color,
            Some(_) => return Err(wrong("filter", "NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL or COLOR")),
        };
        let mode = match extension.get("mode").and_then(Value::as_str) {
            Some("ATTRIBUTES") => Mode::Attributes(filter),
            Some("TRIANGLES") => Mode::Triangles,
            Some("INDICES") => Mode::Indices,
            _ => return Err(wrong("mode", "ATTRIBUTES, TRIANGLES or INDICES")),
        };
        let (fits, expected) = match mode {
            Mode::Attributes(Filter::Octahedral | Filter::Color) => (matches!(stride, 4 | 8), "4 or 8"),
            Mode::Attributes(Filter::Quaternion) => (stride == 8, "8"),
            Mode::Attributes(_) => {
                ((4..=256).contains(&stride) && stride % 4 == 0, "a multiple of 4 from 4 to 256")
            }
            Mode::Triangles | Mode::Indices => (matches!(stride, 2 | 4), "2 or 4"),
        };
        if !fits {
            return Err(wrong("byteStride", expected));
        }
        if mode == Mode::Triangles && count % 3 != 0 {
            return Err(wrong("count", "a multiple of 3"));
        }
        if !matches!(mode, Mode::Attributes(_)) && filter != Filter::None {
            return Err(wrong("filter", "NONE for indices"));
        }
        Ok(Self { mode, count, stride })
    }

    /// Bytes of the decoded data; `None` if they cannot be counted.
    pub(super) fn length(&self) -> Option<usize> {
        self.count.checked_mul(self.stride)
    }

    /// Decodes a stream into [`Self::length`] bytes; what is broken is told.
    pub(super) fn decode(&self, stream: &[u8]) -> Result<Vec<u8>, String> {
        let decoded = match (self.mode, self.stride) {
            (Mode::Attributes(filter), _) => DECODERS[self.stride / 4 - 1](stream, self.count)
                .map(|words| bytemuck::cast_slice(&filtered(words, filter, self.stride)).to_vec()),
            (Mode::Triangles, 2) => meshopt::decode_index_buffer::<u16>(stream, self.count).map(shorts),
            (Mode::Triangles, _) => meshopt::decode_index_buffer::<u32>(stream, self.count).map(words),
            (Mode::Indices, 2) => meshopt::decode_index_sequence::<u16>(stream, self.count).map(shorts),
            (Mode::Indices, _) => meshopt::decode_index_sequence::<u32>(stream, self.count).map(words),
        };
        decoded.map_err(|error| match error {
            meshopt::Error::Native(code) => format!("the compressed data are broken (code {code})"),
            other => format!("the compressed data cannot be decoded: {other}"),
        })
    }
}

fn shorts(values: Vec<u16>) -> Vec<u8> {
    values.into_iter().flat_map(u16::to_le_bytes).collect()
}

fn words(values: Vec<u32>) -> Vec<u8> {
    values.into_iter().flat_map(u32::to_le_bytes).collect()
}

fn filtered(mut words: Vec<u32>, filter: Filter, stride: usize) -> Vec<u32> {
    match (filter, stride) {
        (Filter::None, _) => {}
        (Filter::Octahedral, 4) => meshopt::decode_filter_oct::<i8>(bytemuck::cast_slice_mut(&mut words)),
        (Filter::Octahedral, _) => meshopt::decode_filter_oct::<i16>(bytemuck::cast_slice_mut(&mut words)),
        (Filter::Quaternion, _) => meshopt::decode_filter_quat(bytemuck::cast_slice_mut(&mut words)),
        // Each component alone.
        (Filter::Exponential, _) => {
            meshopt::decode_filter_exp::<1>(bytemuck::cast_slice_mut(&mut words));
        }
        (Filter::Color, 4) => meshopt::decode_filter_color::<u8>(bytemuck::cast_slice_mut(&mut words)),
        (Filter::Color, _) => meshopt::decode_filter_color::<u16>(bytemuck::cast_slice_mut(&mut words)),
    }
    words
}

/// An element of `N` words; arrays that long have no default of their own.
#[derive(Clone)]
struct Element<const N: usize>([u32; N]);

impl<const N: usize> Default for Element<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

fn decode_elements<const N: usize>(stream: &[u8], count: usize) -> meshopt::Result<Vec<u32>> {
    let elements = meshopt::decode_vertex_buffer::<Element<N>>(stream, count)?;
    Ok(elements.into_iter().flat_map(|element| element.0).collect())
}

/// Decodes so many elements of one size to words.
type Decoder = fn(&[u8], usize) -> meshopt::Result<Vec<u32>>;

/// By words of an element less one: the library takes the size of an element as a type.
const DECODERS: [Decoder; 64] = {
    macro_rules! decoders {
        ($($words:literal)*) => { [$(decode_elements::<$words>),*] };
    }
    decoders!(
        1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32
        33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63 64
    )
};
