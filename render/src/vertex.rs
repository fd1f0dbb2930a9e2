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
    /// Square roots of the emission divided by a scale, then the scale in eighths.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_keep_their_direction() {
        for i in 0..1000 {
            let (a, b) = (i as f32 * 0.37, i as f32 * 0.0029);
            let n = Vec3::new(a.cos() * b.sin(), b.cos(), a.sin() * b.sin()).normalize();
            let bits = pack_normal(n * 3.0);
            let read = [0, 10, 20].map(|shift| (bits >> shift & 1023) as f32 / 1023.0 * 2.0 - 1.0);
            assert!(Vec3::from(read).normalize().angle_between(n).to_degrees() < 0.12, "{n}");
        }
        assert_eq!(pack_normal(Vec3::ZERO), pack_normal(Vec3::splat(1e-30)));
    }

    #[test]
    fn dark_colours_keep_their_precision() {
        for linear in [0.0f32, 0.001, 0.01, 0.2, 0.5, 1.0] {
            let byte = pack_color([linear; 4], None)[0];
            let read = (f32::from(byte) / 255.0).powi(2);
            assert!((read - linear).abs() <= 0.0041 * linear.sqrt() + 1e-5, "{linear}: {read}");
        }
        assert_eq!(pack_color([1.0, 1.0, 1.0, 0.5], Some([255, 0, 255, 128])), [255, 0, 255, 64]);
    }

    #[test]
    fn emission_may_be_stronger_than_white() {
        for emissive in [[0.0; 3], [0.2, 1.0, 0.0], [4.0, 0.5, 12.0], [100.0, 31.0, 1.0]] {
            let [r, g, b, eighths] = pack_emissive(emissive);
            let scale = f32::from(eighths) / 8.0;
            for (byte, wanted) in [r, g, b].into_iter().zip(emissive) {
                let read = (f32::from(byte) / 255.0).powi(2) * scale;
                assert!((read - wanted.min(31.875)).abs() < 0.01 * scale, "{wanted}: {read}");
            }
        }
    }

    #[test]
    fn normals_of_mirrored_and_squeezed_objects_stay_at_right_angles() {
        let linear = DMat3::from_rotation_x(0.7) * DMat3::from_diagonal(DVec3::new(-2.0, 0.5, 1e-9));
        let (tangent, normal) = (DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, -1.0, 0.0).normalize());
        let turned = turn_normal(&normal_matrix(linear), normal.as_vec3().to_array()).as_dvec3();
        assert!((linear * tangent).normalize().dot(turned).abs() < 1e-6);
        assert!((linear * normal).dot(turned) > 0.0, "outside stays outside");
    }
}
