//! What the vertex shader reads.

use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3, Vec3};

use crate::{AlphaMode, Material};

/// One vertex, 32 bytes. Texture coordinates lie in a buffer of their own.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Vertex {
    /// Metres from the cluster's origin, or mesh space.
    pub(crate) position: [f32; 3],
    /// Ten bits each of x, y, z, from -1 to 1.
    pub(crate) normal: u32,
    /// Square roots of the linear colour (so that dark ones keep their precision), then alpha.
    pub(crate) color: [u8; 4],
    /// Metallic, roughness, cutoff, unused.
    pub(crate) surface: [u8; 4],
    /// Square roots of the emission divided by the scale, then an eighth of the scale in 255ths... see [`pack_emissive`].
    pub(crate) emissive: [u8; 4],
    /// Id of the object, 0 for instances, which bring theirs.
    pub(crate) object: u32,
}

/// Where one instance or one cluster of merged objects stands, 52 bytes.
#[derive(Clone, Copy, Debug, Pod, Zeroable, PartialEq)]
#[repr(C)]
pub(crate) struct Row {
    /// Columns of the linear part, then the place relative to the eye.
    pub(crate) columns: [[f32; 3]; 4],
    /// Id of the object; 0 for clusters, whose vertices bring theirs.
    pub(crate) object: u32,
}

/// One end of a line, 16 bytes.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LineVertex {
    /// Relative to the eye.
    pub(crate) position: [f32; 3],
    /// sRGB and alpha.
    pub(crate) color: [u8; 4],
}

/// 0 to 1 as a byte.
pub(crate) fn unorm8(x: f32) -> u8 {
    // The cast clamps and makes NaN 0.
    (x * 255.0 + 0.5) as u8
}

/// A direction in ten bits each; what has no direction becomes zero.
pub(crate) fn pack_normal(normal: Vec3) -> u32 {
    let bits = |x: f32| ((x * 0.5 + 0.5) * 1023.0 + 0.5) as u32 & 1023;
    let n = normal.normalize_or_zero();
    bits(n.x) | bits(n.y) << 10 | bits(n.z) << 20
}

/// What all vertices of a material share: colour factor, surface and emission.
pub(crate) fn pack_material(material: &Material) -> ([f32; 4], [u8; 4], [u8; 4]) {
    let cutoff = if let AlphaMode::Mask(cutoff) = material.alpha { cutoff } else { 0.0 };
    // Rounded up: an alpha that equals the cutoff byte must survive a cutoff it equals.
    let surface = [unorm8(material.metallic), unorm8(material.roughness), unorm8(cutoff), 0];
    (material.base_color.map(|x| x.clamp(0.0, 1.0)), surface, pack_emissive(material.emissive))
}

/// Emission up to 31 times white: three square roots and, in eighths, the scale they were divided by.
pub(crate) fn pack_emissive(emissive: [f32; 3]) -> [u8; 4] {
    let most = emissive.into_iter().fold(0.0, f32::max);
    let eighths = (most * 8.0).ceil().clamp(8.0, 255.0);
    let [r, g, b] = emissive.map(|x| unorm8((x.max(0.0) * 8.0 / eighths).min(1.0).sqrt()));
    [r, g, b, eighths as u8]
}

/// Vertex colour times base colour.
pub(crate) fn pack_color(base: [f32; 4], vertex: Option<[u8; 4]>) -> [u8; 4] {
    let vertex = vertex.unwrap_or([255; 4]).map(|x| f32::from(x) / 255.0);
    let [r, g, b] = [0, 1, 2].map(|i| unorm8((base[i] * vertex[i]).sqrt()));
    [r, g, b, unorm8(base[3] * vertex[3])]
}

/// Turns normals as a linear part turns surfaces: transposed cofactors, with the sign of the determinant taken out.
pub(crate) fn normal_matrix(linear: DMat3) -> DMat3 {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = linear;
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if x.dot(y.cross(z)) < 0.0 { -cofactors } else { cofactors }
}

/// A direction through a normal matrix, to f32 only when it has length 1: cofactors of small parts underflow.
pub(crate) fn turn_normal(matrix: &DMat3, normal: [f32; 3]) -> Vec3 {
    (*matrix * Vec3::from(normal).as_dvec3()).normalize_or(DVec3::ZERO).as_vec3()
}
