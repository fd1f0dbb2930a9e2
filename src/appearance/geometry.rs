//! Primitives: the vertices in use, and triangles of them.

use super::attributes::{Attributes, Choice, Elements};
use super::materials::Materials;
use crate::gltf::Document;
use crate::scene::accessors::open;
use crate::scene::notes::Notes;
use crate::scene::places::Places;
use crate::scene::primitives::{MeshPlan, Primitive};
use glam::{Vec2, Vec3, Vec4};
use std::collections::BTreeMap;
use svs_render::Mesh;

/// What meshes are read with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Geometry<'a> {
    pub(super) doc: &'a Document,
    pub(super) materials: &'a Materials,
    pub(super) attributes: &'a Attributes,
}

/// The attributes of a primitive, as many elements each as there are positions.
struct Sources {
    positions: Elements,
    normals: Option<Elements>,
    colors: Option<Elements>,
    uvs: Option<Elements>,
}

impl Geometry<'_> {
    /// A mesh with one primitive for each that has something to draw.
    pub(super) fn mesh(&self, plan: &MeshPlan) -> (Mesh, Notes) {
        let mut notes = Notes::default();
        let mut decoded = BTreeMap::new();
        let read = plan.primitives.iter().filter_map(|primitive| {
            let read = self.primitive(primitive, &mut decoded);
            if read.is_none() {
                notes.add("PRIMITIVE_UNREADABLE", "primitives cannot be read and are left out", || {
                    primitive.pointer.clone()
                });
            }
            read.filter(|primitive| !primitive.indices.is_empty())
        });
        (Mesh { primitives: read.collect() }, notes)
    }

    fn primitive(
        &self,
        primitive: &Primitive,
        decoded: &mut BTreeMap<usize, Elements>,
    ) -> Option<svs_render::Primitive> {
        // Counted when all attributes were looked at.
        let choice = self.attributes.choose(self.doc, primitive, self.materials, &mut Notes::default());
        let is_repeated = decoded.contains_key(&primitive.position);
        let sources = self.sources(primitive, choice, decoded)?;
        let indices = match primitive.indices {
            None => None,
            Some(accessor) => Some(open(self.doc, accessor, "").ok()?.read_indices_u32().ok()?),
        };
        let count = sources.positions.len();
        let is_shared = is_repeated || self.attributes.is_shared(primitive.position);
        let mut places = Places::new(count, is_shared);
        let mut out = svs_render::Primitive {
            material: self.materials.index(primitive.material),
            ..svs_render::Primitive::default()
        };
        for t in 0..primitive.topology.triangle_count(indices.as_ref().map_or(count, Vec::len)) {
            let corners = primitive.topology.corners(t);
            let corners = corners.map(|place| indices.as_ref().map_or(place as u32, |list| list[place]));
            let usable =
                |&corner: &u32| sources.positions.get(corner as usize).is_some_and(|p| p.is_finite());
            if !corners.iter().all(usable) {
                continue;
            }
            for corner in corners {
                let (place, is_new) = places.place(corner, out.positions.len())?;
                if is_new {
                    sources.copy(corner as usize, &mut out);
                }
                out.indices.push(place);
            }
        }
        // One normal that is none would be a black spot: the faces' own are better then.
        if out.normals.contains(&[0.0; 3]) {
            out.normals.clear();
        }
        if let Some((_, transform)) = self.materials.mapping(primitive.material) {
            for uv in &mut out.uvs {
                *uv = transform.apply(Vec2::from_array(*uv)).to_array();
            }
        }
        Some(out)
    }

    fn sources(
        &self,
        primitive: &Primitive,
        choice: Choice,
        decoded: &mut BTreeMap<usize, Elements>,
    ) -> Option<Sources> {
        let mut elements = |accessor: usize| {
            if let Some(elements) = decoded.get(&accessor) {
                return Some(elements.clone());
            }
            let elements = self.attributes.elements(self.doc, accessor)?;
            decoded.insert(accessor, elements.clone());
            Some(elements)
        };
        let positions = elements(primitive.position)?;
        let mut attribute = |accessor: Option<usize>| {
            accessor.and_then(&mut elements).filter(|found| found.len() == positions.len())
        };
        let (normals, colors, uvs) =
            (attribute(choice.normal), attribute(choice.color), attribute(choice.uv));
        Some(Sources { positions, normals, colors, uvs })
    }
}

impl Sources {
    /// Appends a vertex (in range).
    fn copy(&self, vertex: usize, out: &mut svs_render::Primitive) {
        out.positions.push(self.positions[vertex].truncate().to_array());
        if let Some(normals) = &self.normals {
            out.normals.push(unit(normals[vertex].truncate()));
        }
        if let Some(colors) = &self.colors {
            out.colors.push(color(colors[vertex]));
        }
        if let Some(uvs) = &self.uvs {
            out.uvs.push([uvs[vertex].x, uvs[vertex].y]);
        }
    }
}

/// Zero for a vector without direction.
fn unit(normal: Vec3) -> [f32; 3] {
    // Scaled first: the square of a long vector's length is infinite.
    let scaled = normal / normal.abs().max_element();
    scaled.try_normalize().unwrap_or(Vec3::ZERO).to_array()
}

/// NaN counts as 1.
fn color(color: Vec4) -> [u8; 4] {
    color.to_array().map(|c| if c.is_nan() { 255 } else { (c.clamp(0.0, 1.0) * 255.0).round() as u8 })
}
