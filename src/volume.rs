//! Boxes and spheres in double precision.

use crate::scene::Mesh;
use glam::{DAffine3, DVec3};

/// Axis-aligned box, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest corner.
    pub min: DVec3,
    /// Largest corner.
    pub max: DVec3,
}

/// Bounding sphere, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub center: DVec3,
    /// Radius, not negative.
    pub radius: f64,
}

impl Aabb {
    /// The box of nothing: any point extends it.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// Contains no point.
    pub fn is_empty(&self) -> bool {
        !(self.min.cmple(self.max).all())
    }

    /// Smallest box that holds both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Middle of the box.
    pub fn center(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }
}

/// The box a loader computes: all eight corners of the mesh's box, transformed.
pub fn box_in_tree(mesh: &Mesh, to_tree: &DAffine3) -> Aabb {
    if !mesh.min.cmple(mesh.max).all() {
        return Aabb::EMPTY;
    }
    let mut bounds = Aabb::EMPTY;
    for corner in 0..8 {
        let pick = |bit: u32, low: f64, high: f64| if corner & bit == 0 { low } else { high };
        let corner = to_tree.transform_point3(DVec3::new(
            pick(1, mesh.min.x, mesh.max.x),
            pick(2, mesh.min.y, mesh.max.y),
            pick(4, mesh.min.z, mesh.max.z),
        ));
        bounds = bounds.union(&Aabb { min: corner, max: corner });
    }
    bounds
}
