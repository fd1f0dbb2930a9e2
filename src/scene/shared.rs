//! Decoded data that several primitives or meshes need, so that nothing is decoded once per use.

use super::SceneError;
use super::accessors::open;
use super::materials::Materials;
use super::primitives::Plan;
use super::vertices::Positions;
use crate::gltf::{AccessorKind, Document};
use crate::parallel;
use glam::Vec2;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Texture coordinates beyond this are refused: f32 tells no texels apart there.
const MAX_UV: f32 = 1.0e9;

/// Decoded accessors by index.
#[derive(Debug)]
pub(super) struct Shared {
    /// POSITION accessors that several meshes use.
    pub(super) positions: BTreeMap<usize, Arc<Positions>>,
    /// Texture coordinates of alpha textures, as stored; `None` where one is not finite or out of range.
    pub(super) uvs: BTreeMap<usize, Option<Arc<Vec<Vec2>>>>,
    /// COLOR_0 accessors of alpha-tested primitives: whether alpha is 1 everywhere.
    pub(super) opaque_colors: BTreeMap<usize, bool>,
}

impl Shared {
    /// Decodes, in parallel, what the plan's meshes share.
    pub(super) fn read(doc: &Document, plan: &Plan, materials: &Materials) -> Result<Shared, SceneError> {
        let mut uvs = BTreeMap::new();
        let mut colors = BTreeMap::new();
        for primitive in plan.meshes.iter().flat_map(|mesh| &mesh.primitives) {
            let material = materials.resolve(&primitive.materials);
            if let Some(mask) = material.cover.mask()
                && let Some(&accessor) = primitive.tex_coords.get(&mask.tex_coord)
            {
                let pointer = || format!("{}/attributes/TEXCOORD_{}", primitive.pointer, mask.tex_coord);
                uvs.entry(accessor).or_insert_with(pointer);
            }
            if let (true, Some(accessor)) = (material.alpha_tested, primitive.color) {
                let pointer = || format!("{}/attributes/COLOR_0", primitive.pointer);
                colors.entry(accessor).or_insert_with(pointer);
            }
        }
        Ok(Shared {
            positions: decode(&plan.shared_positions, |accessor, pointer| {
                Positions::read(doc, accessor, pointer).map(Arc::new)
            })?,
            uvs: decode(&uvs, |accessor, pointer| read_uvs(doc, accessor, pointer))?,
            opaque_colors: decode(&colors, |accessor, pointer| is_opaque(doc, accessor, pointer))?,
        })
    }
}

/// Decodes accessors, each with the pointer of a use; the first error in accessor order counts, whichever a
/// thread meets first.
fn decode<T: Send>(
    accessors: &BTreeMap<usize, String>,
    read: impl Fn(usize, &str) -> Result<T, SceneError> + Sync,
) -> Result<BTreeMap<usize, T>, SceneError> {
    let accessors: Vec<_> = accessors.iter().collect();
    let decoded = parallel::map(&accessors, |&(&accessor, pointer)| {
        read(accessor, pointer).map(|data| (accessor, data))
    });
    decoded.into_iter().collect()
}

fn read_uvs(doc: &Document, accessor: usize, pointer: &str) -> Result<Option<Arc<Vec<Vec2>>>, SceneError> {
    let uvs = open(doc, accessor, pointer)?.read_vec2_f32();
    let uvs = uvs.map_err(|source| SceneError::Accessor { pointer: pointer.to_owned(), source })?;
    // Written so that NaN is out of range.
    let usable = uvs.iter().all(|uv| uv.x.abs() <= MAX_UV && uv.y.abs() <= MAX_UV);
    Ok(usable.then(|| Arc::new(uvs)))
}

fn is_opaque(doc: &Document, accessor: usize, pointer: &str) -> Result<bool, SceneError> {
    let accessor = open(doc, accessor, pointer)?;
    if accessor.kind != AccessorKind::Vec4 {
        return Ok(true);
    }
    let colors = accessor.read_vec4_f32();
    let colors = colors.map_err(|source| SceneError::Accessor { pointer: pointer.to_owned(), source })?;
    // 1 as 8-bit codes round it; NaN is not 1.
    Ok(colors.iter().all(|color| color.w >= 1.0 - 0.5 / 255.0))
}
