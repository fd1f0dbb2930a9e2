//! What is drawn in one frame, and the camera as the shaders want it.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use crate::{Line, View};

/// What to draw.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The camera.
    pub view: View,
    /// Ids of the objects to draw; their order and repetitions do not matter, ids out of range are left out.
    pub objects: &'a [u32],
    /// Lines of the overlay.
    pub lines: &'a [Line],
}

/// The camera in the shader, 96 bytes.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FrameUniform {
    right_near: [f32; 4],
    up: [f32; 4],
    forward: [f32; 4],
    corner: [f32; 4],
    step_x: [f32; 4],
    step_y: [f32; 4],
}

impl FrameUniform {
    pub(crate) fn new(view: &View, width: u32, height: u32) -> Self {
        let tangent = (view.vertical_fov * 0.5).tan();
        let (w, h) = (f64::from(width), f64::from(height));
        let (wide, high) = (tangent * w / h, tangent);
        let (right, up) = (view.right(), view.up);
        let vec4 = |v: DVec3, last: f64| [v.x as f32, v.y as f32, v.z as f32, last as f32];
        Self {
            right_near: vec4(right / wide, view.near),
            up: vec4(up / high, 0.0),
            forward: vec4(view.forward, 0.0),
            corner: vec4(view.forward - right * wide + up * high, 0.0),
            step_x: vec4(right * (2.0 * wide / w), 0.0),
            step_y: vec4(up * (-2.0 * high / h), 0.0),
        }
    }

    /// The shader's `to_clip`.
    #[cfg(test)]
    fn to_clip(self, p: glam::Vec3) -> [f32; 4] {
        let row = |r: [f32; 4]| glam::Vec3::new(r[0], r[1], r[2]).dot(p);
        [row(self.right_near), row(self.up), self.right_near[3], row(self.forward)]
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3};

    use super::*;

    #[test]
    fn clip_space_agrees_with_the_view_matrix() {
        let view = View::looking_along(DVec3::new(3.0, 2.0, 1.0), DVec3::new(1.0, -0.3, 0.4), 0.9, 0.25);
        let projection: DMat4 =
            glam::dcamera::rh::proj::directx::perspective_infinite_reverse(0.9, 160.0 / 90.0, 0.25);
        let uniform = FrameUniform::new(&view, 160, 90);
        for p in [DVec3::new(8.0, 1.0, 4.0), DVec3::new(9.0, -2.0, 2.0), DVec3::new(100.0, 3.0, 60.0)] {
            let expected = projection * view.view_matrix() * p.extend(1.0);
            let [x, y, z, w] = uniform.to_clip((p - view.eye).as_vec3());
            let difference = (glam::Vec4::new(x, y, z, w).as_dvec4() - expected).abs().max_element();
            assert!(difference < 1e-4, "{difference}");
        }
    }
}
