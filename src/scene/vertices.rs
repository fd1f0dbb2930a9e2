//! Decoded positions, and the vertices of one mesh picked from them.

use super::SceneError;
use super::accessors::open;
use super::bounds::Box3;
use super::materials::UvTransform;
use super::places::Places;
use crate::gltf::{Accessor, ComponentType, Document};
use glam::{DVec3, Vec2};
use std::sync::Arc;

/// A POSITION accessor's data.
#[derive(Debug)]
pub(super) struct Positions {
    /// May hold non-finite points.
    pub(super) points: Vec<DVec3>,
    /// As a loader sees it: the accessor's `min` and `max` if they hold the data, else the box of the finite
    /// points.
    pub(super) bounds: Box3,
    /// `bounds` are those the file states, or there is nothing to bound.
    pub(super) stated_bounds_fit: bool,
}

impl Positions {
    pub(super) fn read(doc: &Document, accessor: usize, pointer: &str) -> Result<Positions, SceneError> {
        let accessor = open(doc, accessor, pointer)?;
        let points = accessor
            .read_vec3_f64()
            .map_err(|source| SceneError::Accessor { pointer: pointer.to_owned(), source })?;
        let data = Box3::of(points.iter().copied());
        Ok(match stated_box(&accessor) {
            _ if data.is_empty() => Positions { points, bounds: data, stated_bounds_fit: true },
            Some(stated) if stated.may_stand_for(&data) => {
                Positions { points, bounds: stated, stated_bounds_fit: true }
            }
            _ => Positions { points, bounds: data, stated_bounds_fit: false },
        })
    }
}

/// The box that a POSITION accessor states.
pub(super) fn stated_box(accessor: &Accessor<'_>) -> Option<Box3> {
    let vector = |v: Vec<f64>| {
        let stored = <[f64; 3]>::try_from(v).ok()?;
        Some(DVec3::from(stored.map(|value| fraction(accessor, value))))
    };
    let (min, max) = accessor.min_max()?;
    Some(Box3 { min: vector(min)?, max: vector(max)? })
}

/// What a stored value stands for: `min` and `max` of normalized integers are stored values (glTF 2.0, 3.6.2.5).
fn fraction(accessor: &Accessor<'_>, stored: f64) -> f64 {
    let max = match accessor.component_type {
        _ if !accessor.normalized => return stored,
        ComponentType::F32 => return stored,
        ComponentType::I8 => 127.0,
        ComponentType::U8 => 255.0,
        ComponentType::I16 => 32_767.0,
        ComponentType::U16 => 65_535.0,
        ComponentType::U32 => f64::from(u32::MAX),
    };
    (stored / max).max(-1.0)
}

/// The vertices of one mesh that come from one [`Positions`]: each gets its place in the mesh when a triangle
/// first uses it.
#[derive(Debug)]
pub(super) struct VertexSet {
    data: Arc<Positions>,
    uvs: Option<(Arc<Vec<Vec2>>, UvTransform)>,
    places: Places,
}

impl VertexSet {
    /// `uvs` are as many as `data` has points; `is_shared`: other sets use the same data.
    pub(super) fn new(
        data: Arc<Positions>,
        uvs: Option<(Arc<Vec<Vec2>>, UvTransform)>,
        is_shared: bool,
    ) -> VertexSet {
        let places = Places::new(data.points.len(), is_shared);
        VertexSet { data, uvs, places }
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.data.points.len()
    }

    /// Position of a vertex (in range).
    pub(super) fn point(&self, vertex: u32) -> DVec3 {
        self.data.points[vertex as usize]
    }

    /// The place of a vertex (in range) in the mesh's `positions` and `uvs`, appended on first use; `None` if
    /// the mesh is full.
    pub(super) fn place(
        &mut self,
        vertex: u32,
        positions: &mut Vec<DVec3>,
        uvs: &mut Vec<Vec2>,
    ) -> Option<u32> {
        let (place, is_new) = self.places.place(vertex, positions.len())?;
        if is_new {
            positions.push(self.data.points[vertex as usize]);
            let uv = |(uvs, transform): &(Arc<Vec<Vec2>>, UvTransform)| transform.apply(uvs[vertex as usize]);
            uvs.push(self.uvs.as_ref().map_or(Vec2::ZERO, uv));
        }
        Some(place)
    }
}
