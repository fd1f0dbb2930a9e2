//! The camera: where the eye is, what it can see, and how large things appear.

use crate::bounds::Bounds;
use glam::{DAffine3, DMat4, DVec3, DVec4};

/// A perspective camera in some space (world, or the space of one tree), in double precision.
///
/// A camera made from values that are not finite culls nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: DVec3,
    /// Points with `normal · p + offset >= 0` for all six are inside. `(0, 0, 0, 1)` stands for no plane.
    planes: [DVec4; 6],
    pixels_per_radian: f64,
    image_area: f64,
}

/// How a box lies to the frustum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Containment {
    Outside,
    Intersects,
    Inside,
}

const NO_PLANE: DVec4 = DVec4::W;

impl Camera {
    /// A camera with an infinite far plane, as most engines have it.
    ///
    /// `view` maps world space to eye space (x right, y up, looking along -z; a rigid transform, uniform scale is
    /// fine). `vertical_fov` is the full opening angle in radians, in (0, π); `width` and `height` are the image in
    /// pixels; `near` is the distance of the near plane in eye-space units.
    pub fn perspective(view: DMat4, vertical_fov: f64, width: f64, height: f64, near: f64) -> Self {
        let tangent = (vertical_fov * 0.5).tan();
        let (x, y) = (height / (width * tangent), 1.0 / tangent);
        // Rows of the clip-space x, y and w; near is w >= near, far is nowhere.
        let rows = [DVec4::X * x, DVec4::Y * y, DVec4::new(0.0, 0.0, -1.0, 0.0)];
        let planes = [
            rows[2] + rows[0],
            rows[2] - rows[0],
            rows[2] + rows[1],
            rows[2] - rows[1],
            rows[2] - DVec4::W * near,
            NO_PLANE,
        ];
        let planes = planes.map(|plane| normalized(view.transpose() * plane));
        Self {
            eye: view.inverse().w_axis.truncate(),
            planes,
            pixels_per_radian: pixels(height * 0.5 / tangent),
            image_area: area(width * height),
        }
    }

    /// A camera from any view-projection matrix, whatever its depth convention (0 to 1 or -1 to 1, reversed or not,
    /// finite or infinite): the near and far planes are taken wide enough for all of them.
    ///
    /// `eye` is the eye in the space the matrix maps from. `pixels_per_radian` is the size in pixels, in the middle
    /// of the image, of something one radian wide: `height / (2 tan(vertical_fov / 2))`.
    pub fn from_view_projection(view_projection: DMat4, eye: DVec3, pixels_per_radian: f64) -> Self {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| view_projection.row(i));
        let planes = [w + x, w - x, w + y, w - y, w + z, w - z].map(normalized);
        let pixels_per_radian = pixels(pixels_per_radian);
        // The inner normals of two sides are π minus the opening angle apart: of the image's side, in pixels.
        let side = |a: DVec4, b: DVec4| {
            let cosine = -a.truncate().dot(b.truncate());
            2.0 * pixels_per_radian * ((1.0 - cosine) / (1.0 + cosine)).sqrt()
        };
        let image_area = area(side(planes[0], planes[1]) * side(planes[2], planes[3]));
        Self { eye, planes, pixels_per_radian, image_area }
    }

    /// The same camera in the local space of an anchor. Rotation, mirroring and uniform scale keep every answer exact
    /// up to rounding; under non-uniform scale only the estimated sizes in pixels become rough.
    pub fn to_local(&self, anchor_to_world: &DAffine3) -> Self {
        // n · (M p) + d = (Mᵀ n) · p + (n · t + d): planes need no inverse.
        let rows = DMat4::from(*anchor_to_world).transpose();
        Self {
            eye: anchor_to_world.inverse().transform_point3(self.eye),
            planes: self.planes.map(|plane| normalized(rows * plane)),
            // Areas and squared distances scale alike.
            pixels_per_radian: self.pixels_per_radian,
            image_area: self.image_area,
        }
    }

    /// Position of the eye.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// Size in pixels, in the middle of the image, of something one radian wide.
    pub fn pixels_per_radian(&self) -> f64 {
        self.pixels_per_radian
    }

    /// Pixels of the whole image.
    pub fn image_area(&self) -> f64 {
        self.image_area
    }

    /// The box may be in sight: no plane has it wholly on its outer side. Errs towards `true` near the edges of the
    /// frustum.
    pub fn sees(&self, bounds: &Bounds) -> bool {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        !self.planes.iter().any(|plane| farthest(plane, min, max) < 0.0)
    }

    /// As [`Self::sees`], and whether every plane has the whole box on its inner side.
    pub(crate) fn contains(&self, bounds: &Bounds) -> Containment {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let mut result = Containment::Inside;
        for plane in &self.planes {
            if farthest(plane, min, max) < 0.0 {
                return Containment::Outside;
            }
            if farthest(plane, max, min) < 0.0 {
                result = Containment::Intersects;
            }
        }
        result
    }
}

/// Signed distance of the box corner farthest along the plane's normal; with the corners swapped, of the nearest.
///
/// Rounding is monotone in each coordinate, so a box inside another one never lies farther out than it does.
#[inline]
fn farthest(plane: &DVec4, min: DVec3, max: DVec3) -> f64 {
    let pick = |normal: f64, min: f64, max: f64| if normal >= 0.0 { max } else { min };
    plane.x * pick(plane.x, min.x, max.x)
        + plane.y * pick(plane.y, min.y, max.y)
        + plane.z * pick(plane.z, min.z, max.z)
        + plane.w
}

/// Scales to a unit normal; a plane without a usable normal (the far plane of an infinite projection) bounds nothing.
fn normalized(plane: DVec4) -> DVec4 {
    let plane = plane / plane.truncate().length();
    if plane.is_finite() { plane } else { NO_PLANE }
}

/// Without a usable scale everything counts as large: nothing is dropped for its size.
fn pixels(pixels_per_radian: f64) -> f64 {
    if pixels_per_radian.is_finite() && pixels_per_radian > 0.0 { pixels_per_radian } else { 1e100 }
}

/// Without a usable image, the largest that is imagined: 32768 by 32768 pixels.
fn area(pixels: f64) -> f64 {
    const LARGEST: f64 = (1_u64 << 30) as f64;
    if pixels > 0.0 && pixels < LARGEST { pixels } else { LARGEST }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dcamera::rh::proj::{directx, opengl};
    use glam::dcamera::rh::view::look_at_mat4;
    use glam::{DQuat, Vec3};
    use proptest::prelude::*;

    fn cube(center: Vec3, half: f32) -> Bounds {
        Bounds { min: center - half, max: center + half }
    }

    fn looking_down_x() -> Camera {
        let view = look_at_mat4(DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 2.0, 3.0), DVec3::Y);
        Camera::perspective(view, 90f64.to_radians(), 200.0, 100.0, 0.1)
    }

    #[test]
    fn frustum_has_the_right_shape() {
        let camera = looking_down_x();
        assert!((camera.eye() - DVec3::new(1.0, 2.0, 3.0)).length() < 1e-12);
        assert!((camera.pixels_per_radian() - 50.0).abs() < 1e-9);
        let at = |x: f32, y: f32, z: f32| camera.sees(&cube(Vec3::new(1.0 + x, 2.0 + y, 3.0 + z), 1e-3));
        assert!(at(10.0, 0.0, 0.0) && at(1e9, 0.0, 0.0));
        assert!(at(10.0, 9.9, 0.0) && !at(10.0, 10.1, 0.0) && !at(10.0, -10.1, 0.0));
        assert!(at(10.0, 0.0, 19.9) && !at(10.0, 0.0, 20.1) && !at(10.0, 0.0, -20.1));
        assert!(!at(-1.0, 0.0, 0.0) && !at(0.05, 0.0, 0.0));
        assert_eq!(camera.contains(&cube(Vec3::new(11.0, 2.0, 3.0), 1.0)), Containment::Inside);
        assert_eq!(camera.contains(&cube(Vec3::new(11.0, 12.0, 3.0), 1.0)), Containment::Intersects);
    }

    #[test]
    fn every_depth_convention_gives_the_same_sides() {
        let eye = DVec3::new(1.0, 2.0, 3.0);
        let view = look_at_mat4(eye, DVec3::new(2.0, 2.0, 3.0), DVec3::Y);
        let fov = 90f64.to_radians();
        for projection in [
            directx::perspective(fov, 2.0, 0.1, 1000.0),
            opengl::perspective(fov, 2.0, 0.1, 1000.0),
            directx::perspective_infinite(fov, 2.0, 0.1),
            directx::perspective_infinite_reverse(fov, 2.0, 0.1),
        ] {
            let camera = Camera::from_view_projection(projection * view, eye, 50.0);
            assert!((camera.image_area() - 20_000.0).abs() < 1e-6, "{}", camera.image_area());
            for x in [-30.0, -3.0, 0.5, 20.0] {
                for y in [-25.0, -2.0, 0.0, 2.0, 25.0] {
                    let bounds = cube(Vec3::new(1.0 + x, 2.0 + y, 3.0), 0.25);
                    assert_eq!(camera.sees(&bounds), looking_down_x().sees(&bounds), "{x} {y}");
                }
            }
        }
    }

    #[test]
    fn a_broken_camera_culls_nothing() {
        let everywhere = [cube(Vec3::ZERO, 1.0), cube(Vec3::splat(-1e30), 1.0)];
        let nan = Camera::perspective(DMat4::NAN, 1.0, 1.0, 1.0, 0.1);
        let flat = Camera::perspective(DMat4::IDENTITY, 1.0, 0.0, 0.0, 0.1);
        assert!(everywhere.iter().all(|b| nan.sees(b)));
        assert!(nan.pixels_per_radian().is_finite() && flat.pixels_per_radian() > 0.0);
        let squashed = looking_down_x().to_local(&DAffine3::from_scale(DVec3::ZERO));
        assert!(everywhere.iter().all(|b| squashed.sees(b)));
    }

    proptest! {
        #[test]
        fn local_cameras_agree_with_the_world(
            angle in 0.0..6.0_f64, scale in 0.01..100.0_f64, mirror in any::<bool>(),
            offset in -50.0..50.0_f64, position in prop::array::uniform3(-40.0..40.0_f32),
        ) {
            let scale = DVec3::new(if mirror { -scale } else { scale }, scale, scale);
            let rotation = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), angle);
            let to_world =
                DAffine3::from_scale_rotation_translation(scale, rotation, DVec3::splat(offset));
            let local = looking_down_x().to_local(&to_world);
            prop_assert!((to_world.transform_point3(local.eye()) - looking_down_x().eye()).length() < 1e-9);
            let point = Vec3::from(position);
            let world = to_world.transform_point3(point.as_dvec3());
            let margin = looking_down_x().planes.iter().map(|p| p.dot(world.extend(1.0))).fold(f64::MAX, f64::min);
            // A point exactly on the boundary may fall either way.
            if margin.abs() > 1e-6 {
                prop_assert_eq!(local.sees(&Bounds { min: point, max: point }), margin > 0.0);
            }
        }
    }
}
