//! Meshes without their vertices: boxes and counts, from the JSON alone.

use super::accessors::{self, open};
use super::bounds::Box3;
use super::primitives::{MeshPlan, Plan};
use super::vertices::{Positions, stated_box};
use super::{Mesh, SceneError};
use crate::gltf::Document;

/// The boxes and counts of a plan's meshes.
///
/// # Errors
/// As reading the meshes, as far as it shows without data.
pub(super) fn read(doc: &Document, plan: &Plan) -> Result<Vec<Mesh>, SceneError> {
    plan.meshes.iter().map(|mesh| outline(doc, mesh)).collect()
}

fn outline(doc: &Document, plan: &MeshPlan) -> Result<Mesh, SceneError> {
    let mut bounds = Box3::EMPTY;
    for primitive in &plan.primitives {
        let pointer = || format!("{}/attributes/POSITION", primitive.pointer);
        let stated = stated_box(&open(doc, primitive.position, &pointer())?);
        // glTF demands the box. Without it there is no way around the data.
        let usable = |b: &Box3| b.min.is_finite() && b.max.is_finite() && !b.is_empty();
        bounds = bounds.union(match stated.filter(usable) {
            Some(stated) => stated,
            None => Positions::read(doc, primitive.position, &pointer())?.bounds,
        });
    }
    let bytes = plan.accessors.iter().filter_map(|&index| doc.accessor(index).ok());
    let bytes = bytes.map(|accessor| accessors::bytes(&accessor)).sum();
    let drawn_triangles = triangles(doc, plan)?;
    Ok(Mesh { drawn_triangles, bytes, min: bounds.min, max: bounds.max, ..Mesh::default() })
}

/// Triangles that a renderer is asked to draw for a mesh.
///
/// # Errors
/// [`SceneError`] if an accessor is broken, or for more than 2^32 - 1.
pub(crate) fn triangles(doc: &Document, plan: &MeshPlan) -> Result<u32, SceneError> {
    let mut triangles = 0_u64;
    for primitive in &plan.primitives {
        let corners = match primitive.indices {
            Some(index) => open(doc, index, &format!("{}/indices", primitive.pointer))?.count,
            None => {
                open(doc, primitive.position, &format!("{}/attributes/POSITION", primitive.pointer))?.count
            }
        };
        triangles += primitive.topology.triangle_count(corners) as u64;
    }
    u32::try_from(triangles).map_err(|_| SceneError::TooLarge {
        pointer: plan.primitives.first().map(|p| p.pointer.clone()).unwrap_or_default(),
        what: "triangles in one mesh",
        limit: u64::from(u32::MAX),
    })
}
