//! Lines on top of the scene: spheres, the frozen camera, the selected object's box.

use glam::DVec3;
use std::f64::consts::TAU;
use svs_render::{Line, View};

/// Straight pieces of a great circle: round enough at the size of a window.
const SEGMENTS: usize = 40;
/// Spheres drawn at most, the largest first: beyond, nobody sees anything any more.
pub const MOST_SPHERES: usize = 400;

/// Colour of the frozen camera's frustum.
pub const FRUSTUM_COLOUR: [u8; 4] = [255, 214, 64, 255];
/// Colour of the selected object's box.
pub const SELECTION_COLOUR: [u8; 4] = [255, 150, 30, 255];
/// Boxes of skipped objects drawn at most.
pub const MOST_BOXES: usize = 30_000;
/// Colour of skipped objects' boxes.
pub const SKIPPED_COLOUR: [u8; 4] = [235, 60, 50, 255];
/// Colour of spheres.
pub const SPHERE_COLOUR: [u8; 4] = [90, 200, 255, 255];

/// Three great circles.
pub fn sphere(center: DVec3, radius: f64, color: [u8; 4], lines: &mut Vec<Line>) {
    for (a, b) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::Z), (DVec3::Z, DVec3::X)] {
        let point = |step: usize| {
            let (sin, cos) = (step as f64 / SEGMENTS as f64 * TAU).sin_cos();
            center + (a * cos + b * sin) * radius
        };
        lines.extend((0..SEGMENTS).map(|step| Line { from: point(step), to: point(step + 1), color }));
    }
}

/// The twelve edges of a box.
pub fn edges(min: DVec3, max: DVec3, color: [u8; 4], lines: &mut Vec<Line>) {
    let corner = |bits: u32| {
        DVec3::new(
            if bits & 1 == 0 { min.x } else { max.x },
            if bits & 2 == 0 { min.y } else { max.y },
            if bits & 4 == 0 { min.z } else { max.z },
        )
    };
    for from in 0..8_u32 {
        for axis in [1, 2, 4] {
            if from & axis == 0 {
                lines.push(Line { from: corner(from), to: corner(from | axis), color });
            }
        }
    }
}

/// A camera's frustum as far as `depth` metres, and a cross through its eye.
pub fn frustum(view: &View, aspect: f64, depth: f64, color: [u8; 4], lines: &mut Vec<Line>) {
    let half = (view.vertical_fov * 0.5).tan();
    let corner = |x: f64, y: f64, depth: f64| {
        view.eye + (view.forward + view.right() * (x * half * aspect) + view.up * (y * half)) * depth
    };
    let around = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    for (index, &(x, y)) in around.iter().enumerate() {
        let (next_x, next_y) = around[(index + 1) % 4];
        lines.push(Line { from: view.eye, to: corner(x, y, depth), color });
        // A small rectangle near the eye shows where the camera stands, the large one where it looks.
        for share in [0.04, 1.0] {
            let depth = depth * share;
            lines.push(Line { from: corner(x, y, depth), to: corner(next_x, next_y, depth), color });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_lie_on_their_sphere() {
        let mut lines = Vec::new();
        sphere(DVec3::new(1.0, 2.0, 3.0), 4.0, SPHERE_COLOUR, &mut lines);
        assert_eq!(lines.len(), 3 * SEGMENTS);
        for line in &lines {
            assert!((line.from.distance(DVec3::new(1.0, 2.0, 3.0)) - 4.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_box_has_twelve_edges_along_the_axes() {
        let mut lines = Vec::new();
        edges(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0), SELECTION_COLOUR, &mut lines);
        assert_eq!(lines.len(), 12);
        let total: f64 = lines.iter().map(|line| line.from.distance(line.to)).sum();
        assert!((total - 24.0).abs() < 1e-9);
    }

    #[test]
    fn a_frustum_opens_as_its_camera_does() {
        let view = View::looking_along(DVec3::ZERO, DVec3::NEG_Z, std::f64::consts::FRAC_PI_2, 0.1);
        let mut lines = Vec::new();
        frustum(&view, 2.0, 10.0, FRUSTUM_COLOUR, &mut lines);
        assert_eq!(lines.len(), 12);
        let far = lines.iter().map(|line| line.to).fold(DVec3::ZERO, DVec3::max);
        assert!((far.x - 20.0).abs() < 1e-9 && (far.y - 10.0).abs() < 1e-9);
    }
}
