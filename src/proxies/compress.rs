//! Meshes as `EXT_meshopt_compression` wants them: in an order that compresses, filtered, and compressed.

use super::encode::Triangles;
use crate::gltf::payload::{Compression, View};
use meshopt::EncodeExpMode;

/// Version of the attribute codec that the extension knows.
const ATTRIBUTES_VERSION: i32 = 0;

/// Steps of positions on the longest side of a primitive's box, at least, as far as floats have them: each is far below the
/// error that the finest proxies have.
const POSITION_STEPS: f32 = 65536.0;

/// Steps of texture coordinates on a texture, as far as floats have them.
const UV_STEPS: f32 = 65536.0;

/// The library's encoders fail for nothing else.
const ENOUGH: &str = "the output has as much room as the library asked for";

/// Bits of an octahedral component: normals are stored in bytes.
const NORMAL_BITS: i32 = 8;

/// Bits of a mantissa with its sign, at most.
const MOST_BITS: i32 = 24;

/// [`Triangles`] in the order of a strip, their vertices in the order of first use, those without use left out.
pub(super) struct Reordered {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    colors: Vec<[u8; 4]>,
    uvs: Vec<[f32; 2]>,
    indices: Vec<u32>,
}

impl Reordered {
    pub(super) fn new(triangles: &Triangles<'_>) -> Self {
        let count = triangles.positions.len();
        let mut indices = meshopt::optimize_vertex_cache_strip(triangles.indices, count);
        let mut place = vec![u32::MAX; count];
        let mut order = Vec::with_capacity(count);
        for index in &mut indices {
            let place = &mut place[*index as usize];
            if *place == u32::MAX {
                *place = order.len() as u32;
                order.push(*index as usize);
            }
            *index = *place;
        }
        fn gather<T: Copy>(values: &[T], order: &[usize], count: usize) -> Vec<T> {
            if values.len() == count { order.iter().map(|&at| values[at]).collect() } else { Vec::new() }
        }
        Self {
            positions: gather(triangles.positions, &order, count),
            normals: gather(triangles.normals, &order, count),
            colors: gather(triangles.colors, &order, count),
            uvs: gather(triangles.uvs, &order, count),
            indices,
        }
    }

    pub(super) fn triangles(&self, material: Option<usize>) -> Triangles<'_> {
        let Self { positions, normals, colors, uvs, indices } = self;
        Triangles { positions, normals, colors, uvs, indices, material }
    }
}

/// Positions for the exponential filter, and what they are after it.
pub(super) fn positions(positions: &[[f32; 3]]) -> (Vec<[u32; 3]>, Vec<[f32; 3]>) {
    let side = |axis: usize| {
        let values = positions.iter().map(|position| position[axis]);
        let (min, max) = values.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        max - min
    };
    let longest = (0..3).map(side).fold(0.0, f32::max);
    exponential(positions, longest / POSITION_STEPS)
}

/// Texture coordinates for the exponential filter.
pub(super) fn uvs(uvs: &[[f32; 2]]) -> Vec<[u32; 2]> {
    exponential(uvs, 1.0 / UV_STEPS).0
}

/// Values for the exponential filter, and what they are after it: multiples of a power of two that is at most `step`, as
/// far as there are bits.
fn exponential<const N: usize>(values: &[[f32; N]], step: f32) -> (Vec<[u32; N]>, Vec<[f32; N]>) {
    let largest = values.as_flattened().iter().fold(0.0f32, |most, value| most.max(value.abs()));
    // Of the numbers below 2^n a mantissa of k bits, one of them the sign, has steps of 2^(n - k + 1).
    let bits = (largest.log2().floor() + 2.0 - step.log2().floor()).clamp(1.0, MOST_BITS as f32);
    // Not a number where there is no extent, and no values but zero.
    let bits = if bits.is_finite() { bits as i32 } else { MOST_BITS };
    let encoded = meshopt::encode_filter_exp(values, bits, EncodeExpMode::SharedComponent);
    let mut decoded = encoded.clone();
    meshopt::decode_filter_exp(&mut decoded);
    let decoded = decoded.into_iter().map(|element| element.map(f32::from_bits)).collect();
    (encoded, decoded)
}

/// Unit vectors for the octahedral filter.
pub(super) fn normals(units: impl Iterator<Item = [f32; 3]>) -> Vec<[i8; 4]> {
    let units: Vec<[f32; 4]> = units.map(|[x, y, z]| [x, y, z, 0.0]).collect();
    meshopt::encode_filter_oct(&units, NORMAL_BITS)
}

/// Compresses a view of vertex attributes with elements of its `byteStride`, of 4, 8 or 12 bytes.
pub(super) fn attributes(view: View, filter: Option<&'static str>) -> View {
    let stride = view.stride.unwrap_or(4) as usize;
    let bytes = match stride {
        4 => encode::<4>(&view.bytes),
        8 => encode::<8>(&view.bytes),
        _ => encode::<12>(&view.bytes),
    };
    let count = view.bytes.len() / stride;
    View { bytes, compression: Some(Compression { mode: "ATTRIBUTES", filter, stride, count }), ..view }
}

fn encode<const N: usize>(bytes: &[u8]) -> Vec<u8> {
    let elements = bytes.as_chunks::<N>().0;
    meshopt::encode_vertex_buffer_level(elements, 0, Some(ATTRIBUTES_VERSION)).expect(ENOUGH)
}

/// Compresses a triangle list of indices of `N` (2 or 4) little-endian bytes.
pub(super) fn index_bytes<const N: usize>(bytes: &[u8]) -> View {
    let word = |index: &[u8; N]| index.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte));
    let indices: Vec<u32> = bytes.as_chunks::<N>().0.iter().map(word).collect();
    let vertices = indices.iter().max().map_or(0, |&last| last as usize + 1);
    triangles(&indices, vertices, N)
}

/// Compresses a triangle list; `size` is 2 or 4, the bytes that an index takes when decoded.
pub(super) fn triangles(indices: &[u32], vertices: usize, size: usize) -> View {
    View {
        bytes: meshopt::encode_index_buffer(indices, vertices).expect(ENOUGH),
        stride: None,
        target: Some(34963),
        compression: Some(Compression {
            mode: "TRIANGLES",
            filter: None,
            stride: size,
            count: indices.len(),
        }),
    }
}
