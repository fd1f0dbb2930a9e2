//! Mesh primitives to the triangles of a [`Mesh`].

use super::accessors::{self, open};
use super::bounds::Box3;
use super::materials::{Cover, MaskTexture, Materials};
use super::notes::Notes;
use super::primitives::{MeshPlan, Plan, Primitive};
use super::shared::Shared;
use super::surfaces::{Group, Groups};
use super::vertices::{Positions, VertexSet};
use super::{Mesh, Opacity, SceneError};
use crate::gltf::Document;
use crate::parallel;
use glam::{DVec3, Vec2, Vec3};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Arc;

/// Reads all meshes of a plan, each once, in parallel; the result does not depend on the thread count.
pub(super) fn read(
    doc: &Document,
    plan: &Plan,
    materials: &Materials,
    notes: &mut Notes,
) -> Result<Vec<Mesh>, SceneError> {
    let shared = Shared::read(doc, plan, materials)?;
    let reader = Reader { doc, materials, shared: &shared };
    // All results first, then the first error in file order: which one a thread meets first is chance.
    let read = parallel::map(&plan.meshes, |mesh| reader.mesh(mesh));
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
    shared: &'a Shared,
}

/// POSITION accessor, and TEXCOORD_n accessor and transform for an alpha texture: primitives that agree in
/// these share their vertices.
type VertexKey = (usize, Option<(usize, [u64; 5])>);

impl Reader<'_> {
    fn mesh(&self, plan: &MeshPlan) -> Result<(Mesh, Notes), SceneError> {
        let mut notes = Notes::default();
        let mut decoded: BTreeMap<usize, Arc<Positions>> = BTreeMap::new();
        let mut sets: BTreeMap<VertexKey, VertexSet> = BTreeMap::new();
        let mut positions: Vec<DVec3> = Vec::new();
        let mut uvs: Vec<Vec2> = Vec::new();
        let mut groups = Groups::default();
        let mut bounds = Box3::EMPTY;
        let mut drawn = 0_u64;

        for primitive in &plan.primitives {
            let (double_sided, cover) = self.surface(primitive, &mut notes);
            let mapping = cover.mask().and_then(|mask| {
                let accessor = *primitive.tex_coords.get(&mask.tex_coord)?;
                let uvs = self.shared.uvs.get(&accessor)?.clone()?;
                Some((accessor, mask, uvs))
            });
            let key = (primitive.position, mapping.as_ref().map(|(uv, mask, _)| (*uv, mask.transform.key())));
            let set = match sets.entry(key) {
                Entry::Occupied(entry) => entry.into_mut(),
                Entry::Vacant(entry) => {
                    let is_repeated = decoded.contains_key(&primitive.position);
                    let data = self.positions(primitive, &mut decoded)?;
                    if !is_repeated {
                        bounds = bounds.union(data.bounds);
                        note_bounds(&data, primitive, &mut notes);
                    }
                    let is_shared = is_repeated || self.shared.positions.contains_key(&primitive.position);
                    let uvs = match &mapping {
                        Some((_, mask, uvs)) => {
                            same_count(primitive, mask, uvs.len(), data.points.len())?;
                            Some((Arc::clone(uvs), mask.transform))
                        }
                        None => None,
                    };
                    entry.insert(VertexSet::new(data, uvs, is_shared))
                }
            };
            let without_uv = cover.mask().is_some() && mapping.is_none();
            let cover = if without_uv {
                notes.add(
                    "MASK_WITHOUT_UV",
                    "alpha-tested primitives lack usable texture coordinates: taken as transparent",
                    || primitive.pointer.clone(),
                );
                &Cover::Transparent
            } else {
                cover
            };
            let group = groups.group(double_sided, cover);
            drawn += self.triangles(primitive, set, group, &mut positions, &mut uvs, &mut notes)?;
        }

        let mesh = assemble(positions, uvs, groups, bounds);
        let bytes = plan.accessors.iter().filter_map(|&index| self.doc.accessor(index).ok());
        let bytes = bytes.map(|accessor| accessors::bytes(&accessor)).sum();
        let drawn_triangles = u32::try_from(drawn).map_err(|_| SceneError::TooLarge {
            pointer: plan.primitives.first().map(|p| p.pointer.clone()).unwrap_or_default(),
            what: "triangles in one mesh",
            limit: u64::from(u32::MAX),
        })?;
        Ok((Mesh { drawn_triangles, bytes, ..mesh }, notes))
    }

    /// Sidedness and cover of a primitive, its vertex colours considered.
    fn surface(&self, primitive: &Primitive, notes: &mut Notes) -> (bool, &Cover) {
        let material = self.materials.resolve(&primitive.materials);
        let color = primitive.color.filter(|_| material.alpha_tested);
        let is_translucent = color.is_some_and(|color| self.shared.opaque_colors.get(&color) == Some(&false));
        if is_translucent && !matches!(material.cover, Cover::Transparent) {
            notes.add(
                "MASK_VERTEX_ALPHA",
                "alpha-tested primitives have alpha in their vertex colours: taken as transparent",
                || primitive.pointer.clone(),
            );
            return (material.double_sided, &Cover::Transparent);
        }
        (material.double_sided, &material.cover)
    }

    /// Positions of a primitive, decoded once for the mesh, or once for all that share them.
    fn positions(
        &self,
        primitive: &Primitive,
        decoded: &mut BTreeMap<usize, Arc<Positions>>,
    ) -> Result<Arc<Positions>, SceneError> {
        Ok(Arc::clone(match decoded.entry(primitive.position) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => entry.insert(match self.shared.positions.get(&primitive.position) {
                Some(shared) => Arc::clone(shared),
                None => {
                    let pointer = format!("{}/attributes/POSITION", primitive.pointer);
                    Arc::new(Positions::read(self.doc, primitive.position, &pointer)?)
                }
            }),
        }))
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

fn note_bounds(data: &Positions, primitive: &Primitive, notes: &mut Notes) {
    if !data.stated_bounds_fit {
        notes.add(
            "BOUNDS_WRONG",
            "POSITION accessors have no usable min and max: computed from the vertices",
            || format!("/accessors/{}", primitive.position),
        );
    }
}

fn same_count(
    primitive: &Primitive,
    mask: &MaskTexture,
    count: usize,
    expected: usize,
) -> Result<(), SceneError> {
    if count == expected {
        return Ok(());
    }
    let pointer = format!("{}/attributes/TEXCOORD_{}", primitive.pointer, mask.tex_coord);
    Err(SceneError::CountMismatch { pointer, count, expected })
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
