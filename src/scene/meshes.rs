//! Mesh primitives to the triangles of a [`Mesh`].

use super::accessors::{self, open};
use super::bounds::Box3;
use super::materials::{Cover, MaskTexture, Materials};
use super::notes::Notes;
use super::primitives::{MeshPlan, Plan, Primitive};
use super::surfaces::{Group, Groups};
use super::vertices::{Positions, VertexSet};
use super::{Mesh, Opacity, SceneError};
use crate::gltf::{AccessorKind, Document};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Reads all meshes of a plan, each once, in parallel; the result does not depend on the thread count.
pub(super) fn read(
    doc: &Document,
    plan: &Plan,
    materials: &Materials,
    notes: &mut Notes,
) -> Result<Vec<Mesh>, SceneError> {
    let shared: Vec<_> = plan.shared_positions.par_iter().collect();
    let shared: Vec<Result<_, SceneError>> = shared
        .into_par_iter()
        .map(|(&accessor, pointer)| Ok((accessor, Arc::new(Positions::read(doc, accessor, pointer)?))))
        .collect();
    let shared: BTreeMap<usize, Arc<Positions>> = shared.into_iter().collect::<Result<_, _>>()?;
    let reader = Reader { doc, materials, shared: &shared };
    // All results first, then the first error in file order: which one a thread meets first is chance.
    let read: Vec<_> = plan.meshes.par_iter().map(|mesh| reader.mesh(mesh)).collect();
    let mut meshes = Vec::with_capacity(read.len());
    for result in read {
        let (mesh, mesh_notes) = result?;
        meshes.push(mesh);
        notes.append(mesh_notes);
    }
    Ok(meshes)
}

struct Reader<'a> {
    doc: &'a Document,
    materials: &'a Materials,
    shared: &'a BTreeMap<usize, Arc<Positions>>,
}

/// A primitive's accessor of positions and how its vertices are mapped to an alpha texture: primitives that
/// agree in both share their vertices.
type VertexKey = (usize, Option<(usize, [u64; 5])>);

impl Reader<'_> {
    fn mesh(&self, plan: &MeshPlan) -> Result<(Mesh, Notes), SceneError> {
        let mut notes = Notes::default();
        let mut sets: BTreeMap<VertexKey, VertexSet> = BTreeMap::new();
        let mut positions: Vec<DVec3> = Vec::new();
        let mut uvs: Vec<Vec2> = Vec::new();
        let mut groups = Groups::default();
        let mut bounds = Box3::EMPTY;
        let mut drawn = 0_u64;

        for primitive in &plan.primitives {
            let (double_sided, cover) = self.surface(primitive, &mut notes)?;
            let key = (primitive.position, cover.mask().map(|m| (m.tex_coord, m.transform.key())));
            if !sets.contains_key(&key) {
                let data = self.positions(primitive)?;
                bounds = bounds.union(data.bounds);
                if !data.stated_bounds_fit {
                    notes.add(
                        "BOUNDS_WRONG",
                        "POSITION accessors have no usable min and max: computed from the vertices",
                        || format!("/accessors/{}", primitive.position),
                    );
                }
                let set_uvs = match cover.mask() {
                    Some(mask) => self.uvs(primitive, mask, &data)?,
                    None => None,
                };
                sets.insert(key, VertexSet::new(data, set_uvs));
            }
            let Some(set) = sets.get_mut(&key) else { continue };
            // A mask whose texture coordinates cannot be used hides nothing.
            let cover = if cover.mask().is_some() && !set.has_uvs() {
                notes.add(
                    "MASK_WITHOUT_UV",
                    "alpha-tested primitives lack usable texture coordinates: taken as transparent",
                    || primitive.pointer.clone(),
                );
                Cover::Transparent
            } else {
                cover
            };
            let group = groups.group(double_sided, &cover);
            drawn += self.triangles(primitive, set, group, &mut positions, &mut uvs, &mut notes)?;
        }

        let mesh = assemble(positions, uvs, groups, bounds);
        let bytes = plan.accessors.iter().filter_map(|&index| self.doc.accessor(index).ok());
        let drawn_triangles = u32::try_from(drawn).map_err(|_| SceneError::TooLarge {
            pointer: plan.primitives.first().map(|p| p.pointer.clone()).unwrap_or_default(),
            what: "triangles in one mesh",
            limit: u64::from(u32::MAX),
        })?;
        let bytes = bytes.map(|accessor| accessors::bytes(&accessor)).sum();
        Ok((Mesh { drawn_triangles, bytes, ..mesh }, notes))
    }

    /// Sidedness and cover of a primitive, its vertex colours considered.
    fn surface(&self, primitive: &Primitive, notes: &mut Notes) -> Result<(bool, Cover), SceneError> {
        let material = self.materials.resolve(&primitive.materials);
        if material.alpha_tested
            && let Some(color) = primitive.color
            && !matches!(material.cover, Cover::Transparent)
        {
            let pointer = format!("{}/attributes/COLOR_0", primitive.pointer);
            let accessor = open(self.doc, color, &pointer)?;
            if accessor.kind == AccessorKind::Vec4 {
                let colors = accessor.read_vec4_f32();
                let colors = colors.map_err(|source| SceneError::Accessor { pointer, source })?;
                // 1 as 8-bit codes round it; NaN is not 1.
                if !colors.iter().all(|color| color.w >= 1.0 - 0.5 / 255.0) {
                    notes.add(
                        "MASK_VERTEX_ALPHA",
                        "alpha-tested primitives have alpha in their vertex colours: taken as transparent",
                        || primitive.pointer.clone(),
                    );
                    return Ok((material.double_sided, Cover::Transparent));
                }
            }
        }
        Ok((material.double_sided, material.cover.clone()))
    }

    fn positions(&self, primitive: &Primitive) -> Result<Arc<Positions>, SceneError> {
        if let Some(shared) = self.shared.get(&primitive.position) {
            return Ok(Arc::clone(shared));
        }
        let pointer = format!("{}/attributes/POSITION", primitive.pointer);
        Positions::read(self.doc, primitive.position, &pointer).map(Arc::new)
    }

    /// Texture coordinates as the alpha texture is looked up; `None` if missing or not finite.
    fn uvs(
        &self,
        primitive: &Primitive,
        mask: &MaskTexture,
        data: &Positions,
    ) -> Result<Option<Vec<Vec2>>, SceneError> {
        let Some(&accessor) = primitive.tex_coords.get(&mask.tex_coord) else { return Ok(None) };
        let pointer = format!("{}/attributes/TEXCOORD_{}", primitive.pointer, mask.tex_coord);
        let accessor = open(self.doc, accessor, &pointer)?;
        let (count, expected) = (accessor.count, data.points.len());
        if count != expected {
            return Err(SceneError::CountMismatch { pointer, count, expected });
        }
        let uvs = accessor.read_vec2_f32().map_err(|source| SceneError::Accessor { pointer, source })?;
        let uvs: Vec<Vec2> = uvs.into_iter().map(|uv| mask.transform.apply(uv)).collect();
        Ok(uvs.iter().all(|uv| uv.is_finite()).then_some(uvs))
    }

    /// Adds the triangles of a primitive that can be hit; returns how many it has in all.
    fn triangles(
        &self,
        primitive: &Primitive,
        set: &mut VertexSet,
        group: Option<&mut Group>,
        positions: &mut Vec<DVec3>,
        uvs: &mut Vec<Vec2>,
        notes: &mut Notes,
    ) -> Result<u64, SceneError> {
        let vertices = set.vertex_count();
        let pointer = || format!("{}/indices", primitive.pointer);
        let indices = match primitive.indices {
            None => None,
            Some(accessor) => {
                let indices = open(self.doc, accessor, &pointer())?.read_indices_u32();
                let indices =
                    indices.map_err(|source| SceneError::Accessor { pointer: pointer(), source })?;
                if let Some(&index) = indices.iter().find(|&&index| index as usize >= vertices) {
                    return Err(SceneError::VertexIndexOutOfRange { pointer: pointer(), index, vertices });
                }
                Some(indices)
            }
        };
        let corners = indices.as_ref().map_or(vertices, Vec::len);
        let count = primitive.topology.triangle_count(corners);
        let too_large = || SceneError::TooLarge {
            pointer: primitive.pointer.clone(),
            what: "vertices in one mesh",
            limit: u64::from(u32::MAX),
        };
        if u32::try_from(vertices).is_err() {
            return Err(too_large());
        }
        let Some(group) = group else { return Ok(count as u64) };

        let (mut not_finite, mut degenerate) = (0, 0);
        for t in 0..count {
            let places = primitive.topology.corners(t);
            // Checked above: places of unindexed primitives fit u32 as their vertices do.
            let corners = places.map(|place| indices.as_ref().map_or(place as u32, |list| list[place]));
            let points = corners.map(|corner| set.point(corner));
            if points.iter().any(|point| !point.is_finite()) {
                not_finite += 1;
            } else if has_no_area(points) {
                degenerate += 1;
            } else {
                let mut triangle = [0; 3];
                for (to, corner) in triangle.iter_mut().zip(corners) {
                    *to = set.place(corner, positions, uvs).ok_or_else(too_large)?;
                }
                group.triangles.push(triangle);
            }
        }
        notes.add_many(
            "VERTEX_NOT_FINITE",
            not_finite,
            "triangles have a NaN or infinite vertex and are left out",
            || primitive.pointer.clone(),
        );
        notes.add_many("DEGENERATE_TRIANGLE", degenerate, "triangles have no area and are left out", || {
            primitive.pointer.clone()
        });
        Ok(count as u64)
    }
}

/// Repeated corners or corners in one line.
fn has_no_area([a, b, c]: [DVec3; 3]) -> bool {
    (b - a).cross(c - a) == DVec3::ZERO
}

/// Moves vertices to the mesh's centre and drops triangles that f32 cannot tell from a line.
fn assemble(positions: Vec<DVec3>, uvs: Vec<Vec2>, groups: Groups, bounds: Box3) -> Mesh {
    let data = Box3::of(positions.iter().copied());
    let origin = if data.is_empty() { DVec3::ZERO } else { data.center() };
    let positions: Vec<Vec3> = positions.into_iter().map(|point| (point - origin).as_vec3()).collect();
    let flat = |triangle: &[u32; 3]| has_no_area(triangle.map(|v| positions[v as usize].as_dvec3()));
    let (triangles, surfaces) = groups.into_surfaces(|triangle| !flat(triangle));
    let masked = surfaces.iter().any(|surface| matches!(surface.opacity, Opacity::Mask(_)));
    let uvs = if masked { uvs } else { Vec::new() };
    Mesh {
        positions,
        origin,
        triangles,
        uvs,
        surfaces,
        drawn_triangles: 0,
        bytes: 0,
        min: bounds.min,
        max: bounds.max,
    }
}
