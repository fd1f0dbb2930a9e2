//! The runtime as one of the methods under test.

use super::methods::Slider;
use super::target::Target;
use super::view::View;
use crate::baked::Baked;
use glam::{DMat3, DMat4};
use svs_runtime::{Camera, SceneCuller, Settings};

/// The runtime, asked for cameras of the item buffer.
pub(super) struct RuntimeSlider<'a> {
    pub baked: &'a Baked,
    pub target: &'a Target,
    pub culler: SceneCuller,
}

impl Slider for RuntimeSlider<'_> {
    fn draw(&mut self, view: &View, settings: &Settings, drawn: &mut Vec<u32>) {
        drawn.clear();
        for &draw in self.culler.cull(&runtime_camera(view), settings) {
            let object = self.baked.object_of(draw);
            drawn.extend(object.and_then(|object| self.target.member_of_object[object as usize]));
        }
    }
}

/// The same camera for the runtime; nothing is too near.
fn runtime_camera(view: &View) -> Camera {
    let to_eye = DMat3::from_cols(view.right, view.up, -view.forward).transpose();
    let matrix = DMat4::from_mat3(to_eye) * DMat4::from_translation(-view.eye);
    let vertical = 2.0 * view.half_height.atan();
    Camera::perspective(matrix, vertical, f64::from(view.width), f64::from(view.height), 0.0)
}
