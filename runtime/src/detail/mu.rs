//! The degree of visibility: estimated visible pixels over the pixels there would be with nothing in front.
//!
//! The thesis (see [`super::metric`]) divides the visible pixels of a node's box by all of its pixels. Here what is visible is
//! counted on the objects' geometry, so what it is divided by is, too: the least of the pixels of the node's box, those of
//! its objects' boxes in sum, and those of the largest areas that were ever seen of its objects, in sum. Without the sums, a
//! few pipes in a large box would count as hidden by the air between them.

use crate::bounds::Bounds;
use crate::boxes::Boxes;
use crate::camera::Camera;
use crate::estimate::is_around;
use crate::proxies::Proxies;
use crate::tree::Tree;
use glam::DVec3;

/// What a proxy, or an object, could show.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// Around all objects, metres of tree space.
    pub(crate) bounds: Bounds,
    /// Area towards x, y and z in m²: of the box, or of the objects' boxes in sum where that is less.
    faces: DVec3,
    /// Areas in m² that were seen of the objects from outside their innermost spheres, at most and in sum.
    area: f64,
}

impl Shape {
    const EMPTY: Self = Self { bounds: Bounds::EMPTY, faces: DVec3::ZERO, area: 0.0 };

    pub(crate) fn of_box(bounds: &Bounds) -> Self {
        Self { bounds: *bounds, faces: faces(bounds), area: f64::INFINITY }
    }

    /// Of the object at `place` in tree order.
    pub(crate) fn of_object(tree: &Tree, bounds: &Bounds, place: u32) -> Self {
        let area = match tree.objects.get(place as usize) {
            Some(object) if object.max_level > 0 => tree.area(object, 1),
            // Never seen from outside of its innermost sphere, or in no sphere: nothing is known.
            Some(object) if object.depth > 0 => 0.0,
            _ => f64::INFINITY,
        };
        Self { area, ..Self::of_box(bounds) }
    }

    /// What it would cover with nothing in front, in pixels; with `clip` of the image only, as far as six planes can tell.
    /// `None` if the eye may be inside.
    fn pixels(&self, camera: &Camera, clip: bool) -> Option<f64> {
        let (min, max) = (self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3());
        let to_eye = camera.eye() - (min + max) * 0.5;
        let distance_squared = to_eye.length_squared();
        if is_around(&self.bounds, distance_squared) || !distance_squared.is_finite() {
            return None;
        }
        let silhouette = self.faces.dot(to_eye.abs()) / distance_squared.sqrt();
        let scale = camera.pixels_per_radian() * camera.pixels_per_radian() / distance_squared;
        let share = if clip { share_inside(camera, min, max) } else { 1.0 };
        Some((silhouette.min(self.area) * scale * share).min(camera.image_area()))
    }

    /// The degree of visibility, 0 to 1, where `visible` pixels are; 1 if the eye may be inside or nothing could be seen.
    pub(crate) fn mu(&self, visible: f64, camera: &Camera, clip: bool) -> f64 {
        self.mu_and_shown(visible, camera, clip).0
    }

    /// The same, and how many of the `visible` pixels there can be at most.
    pub(crate) fn mu_and_shown(&self, visible: f64, camera: &Camera, clip: bool) -> (f64, f64) {
        match self.pixels(camera, clip) {
            Some(pixels) if pixels > 0.0 => ((visible / pixels).clamp(0.0, 1.0), visible.min(pixels)),
            _ => (1.0, visible),
        }
    }
}

/// The box's extent inside each plane over its whole extent along the plane's normal, multiplied.
fn share_inside(camera: &Camera, min: DVec3, max: DVec3) -> f64 {
    camera.planes().iter().fold(1.0, |share, plane| {
        let (far, near) = (Camera::farthest(plane, min, max), Camera::farthest(plane, max, min));
        if near < 0.0 { share * (far / (far - near)).clamp(0.0, 1.0) } else { share }
    })
}

fn faces(bounds: &Bounds) -> DVec3 {
    let size = bounds.max.as_dvec3() - bounds.min.as_dvec3();
    DVec3::new(size.y * size.z, size.z * size.x, size.x * size.y)
}

/// What each proxy of a tree could show. Linear in proxies plus objects.
pub(crate) fn shapes(tree: &Tree, proxies: &Proxies, objects: &[Bounds]) -> Vec<Shape> {
    let nodes = proxies.nodes();
    let mut shapes = vec![Shape::EMPTY; nodes.len()];
    let add = |shape: &mut Shape, other: &Shape| {
        shape.bounds.extend(&other.bounds);
        shape.faces += other.faces;
        shape.area += other.area;
    };
    for (position, node) in proxies.innermost().enumerate() {
        if let Some(node) = node {
            let place = proxies.object(position as u32);
            add(&mut shapes[node as usize], &Shape::of_object(tree, &objects[place as usize], place));
        }
    }
    // Children come later than their parents.
    for (node, parent) in proxies.parents().into_iter().enumerate().rev() {
        let shape = shapes[node];
        if let Some(parent) = parent {
            add(&mut shapes[parent as usize], &shape);
        }
        if nodes[node].object_count > 0 {
            shapes[node].faces = shape.faces.min(faces(&shape.bounds));
        }
    }
    shapes
}

/// Distance of the eye from the nearest point of a box, metres; 0 inside.
pub(crate) fn distance(bounds: &Bounds, eye: DVec3) -> f64 {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    (min - eye).max(eye - max).max(DVec3::ZERO).length()
}

impl Boxes {
    /// The shape of a proxy.
    pub(crate) fn proxy(&self, node: u32) -> &Shape {
        &self.proxies[node as usize]
    }
}
