//! Parses mesh primitives and plans their reading: what is shared, and whether it stays within bounds.

use super::SceneError;
use super::accessors::{has_data, open};
use super::json::{array, extension, index, malformed, optional_index};
use super::notes::Notes;
use super::triangulate::Topology;
use crate::gltf::Document;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

const DRACO: &str = "KHR_draco_mesh_compression";
const VARIANTS: &str = "KHR_materials_variants";

/// Index entries cost at least a byte each in the file, and few files draw the same data through more than a
/// handful of meshes: more corners than this plus 64 times the file's size would be an attack on memory.
const FREE_CORNERS: u64 = 1 << 24;

/// A primitive with triangles.
#[derive(Debug)]
pub(crate) struct Primitive {
    /// JSON pointer of the primitive.
    pub(crate) pointer: String,
    pub(crate) topology: Topology,
    /// POSITION accessor.
    pub(crate) position: usize,
    pub(crate) indices: Option<usize>,
    /// Material and those that replace it as variants (`KHR_materials_variants`); `None`: default material.
    pub(crate) materials: Vec<Option<usize>>,
    /// COLOR_0 accessor: its alpha multiplies the material's.
    pub(crate) color: Option<usize>,
    /// The material that draws it as long as no variant is chosen; `None`: default material.
    pub(crate) material: Option<usize>,
    /// NORMAL accessor.
    pub(crate) normal: Option<usize>,
    /// TEXCOORD_n accessors by n.
    pub(crate) tex_coords: BTreeMap<usize, usize>,
}

/// A mesh ready to be read.
#[derive(Debug)]
pub(crate) struct MeshPlan {
    pub(crate) primitives: Vec<Primitive>,
    /// Distinct accessors of all its primitives.
    pub(crate) accessors: BTreeSet<usize>,
    pub(crate) has_morph_targets: bool,
}

/// What is to be read for all meshes in use.
#[derive(Debug, Default)]
pub(crate) struct Plan {
    pub(crate) meshes: Vec<MeshPlan>,
    /// POSITION accessors that several meshes use, each with the pointer of a use.
    pub(crate) shared_positions: BTreeMap<usize, String>,
    /// Materials in use.
    pub(crate) materials: BTreeSet<usize>,
}

/// Parses the primitives of `meshes` (glTF mesh indices, in range).
pub(crate) fn plan(doc: &Document, meshes: &[usize], notes: &mut Notes) -> Result<Plan, SceneError> {
    let mut plan = Plan::default();
    let mut first_user: BTreeMap<usize, (usize, String)> = BTreeMap::new();
    let bytes = doc.described_bytes();
    let limit = FREE_CORNERS.saturating_add(bytes.saturating_mul(64));
    let mut corners = 0_u64;
    let mut counted_uvs = BTreeSet::new();
    for (m, &mesh) in meshes.iter().enumerate() {
        let mesh_plan = plan_mesh(doc, mesh, notes)?;
        for primitive in &mesh_plan.primitives {
            plan.materials.extend(primitive.materials.iter().flatten());
            let place = || format!("{}/attributes/POSITION", primitive.pointer);
            let vertices = open(doc, primitive.position, &place())?.count as u64;
            let indices = match primitive.indices {
                Some(index) => open(doc, index, &format!("{}/indices", primitive.pointer))?.count as u64,
                None => vertices,
            };
            corners = corners.saturating_add(indices);
            for &accessor in primitive.tex_coords.values() {
                if counted_uvs.insert(accessor) {
                    let count = doc.accessor(accessor).map_or(0, |accessor| accessor.count as u64);
                    corners = corners.saturating_add(count);
                }
            }
            match first_user.get(&primitive.position) {
                Some((user, pointer)) if *user != m => {
                    plan.shared_positions.entry(primitive.position).or_insert_with(|| pointer.clone());
                }
                Some(_) => {}
                None => {
                    corners = corners.saturating_add(vertices);
                    first_user.insert(primitive.position, (m, place()));
                }
            }
            if corners > limit {
                let pointer = primitive.pointer.clone();
                return Err(SceneError::TooLarge { pointer, what: "triangle corners and vertices", limit });
            }
        }
        plan.meshes.push(mesh_plan);
    }
    Ok(plan)
}

/// POSITION accessors of all meshes of a file, each once; what is no index is left to [`plan`].
pub(crate) fn positions(json: &Value) -> BTreeSet<usize> {
    let meshes = json.get("meshes").and_then(Value::as_array).into_iter().flatten();
    let primitives = meshes.filter_map(|mesh| mesh.get("primitives")?.as_array()).flatten();
    let positions = primitives.filter_map(|primitive| primitive.get("attributes")?.get("POSITION")?.as_u64());
    positions.filter_map(|index| usize::try_from(index).ok()).collect()
}

fn plan_mesh(doc: &Document, mesh: usize, notes: &mut Notes) -> Result<MeshPlan, SceneError> {
    let pointer = format!("/meshes/{mesh}");
    let json = &array(&doc.json, "meshes", "")?[mesh];
    let mut plan = MeshPlan { primitives: Vec::new(), accessors: BTreeSet::new(), has_morph_targets: false };
    for (p, primitive) in array(json, "primitives", &pointer)?.iter().enumerate() {
        let pointer = format!("{pointer}/primitives/{p}");
        if !array(primitive, "targets", &pointer)?.is_empty() {
            plan.has_morph_targets = true;
        }
        plan.accessors.extend(accessors_of(primitive));
        if let Some(primitive) = parse(doc, primitive, pointer, notes)? {
            plan.primitives.push(primitive);
        }
    }
    Ok(plan)
}

/// All accessors a primitive names, for the byte count; what is no index is left to [`parse`].
fn accessors_of(primitive: &Value) -> impl Iterator<Item = usize> {
    let targets = primitive.get("targets").and_then(Value::as_array).into_iter().flatten();
    let attributes = primitive.get("attributes").into_iter().chain(targets);
    let attributes = attributes.filter_map(Value::as_object).flat_map(|object| object.values());
    let values = attributes.chain(primitive.get("indices"));
    values.filter_map(Value::as_u64).filter_map(|index| usize::try_from(index).ok())
}

/// `None` for a primitive that draws no triangles.
fn parse(
    doc: &Document,
    json: &Value,
    pointer: String,
    notes: &mut Notes,
) -> Result<Option<Primitive>, SceneError> {
    let accessors = array(&doc.json, "accessors", "")?.len();
    let materials = array(&doc.json, "materials", "")?.len();
    let mode = json.get("mode").map_or(Ok(4), |mode| index(mode, || format!("{pointer}/mode")))?;
    let topology = Topology::from_mode(mode)
        .ok_or_else(|| malformed(format!("{pointer}/mode"), "a primitive mode, 0 to 6"))?;
    let Some(topology) = topology else {
        notes.add("LINES_OR_POINTS", "primitives are lines or points and are left out", || pointer);
        return Ok(None);
    };
    let empty = Value::Null;
    let attributes = json.get("attributes").unwrap_or(&empty);
    let place = format!("{pointer}/attributes");
    let attribute = |name: &str| optional_index(attributes, name, "accessors", accessors, &place);
    let Some(position) = attribute("POSITION")? else {
        notes.add("NO_POSITION", "primitives without POSITION are left out", || pointer);
        return Ok(None);
    };
    let indices = optional_index(json, "indices", "accessors", accessors, &pointer)?;
    if extension(json, DRACO).is_some()
        && [Some(position), indices].iter().flatten().any(|&a| !has_data(doc, a))
    {
        return Err(SceneError::Compressed { pointer, extension: DRACO });
    }

    let material = optional_index(json, "material", "materials", materials, &pointer)?;
    let mut used = vec![material];
    if let Some(variants) = extension(json, VARIANTS) {
        let pointer = format!("{pointer}/extensions/{VARIANTS}");
        for (i, mapping) in array(variants, "mappings", &pointer)?.iter().enumerate() {
            let pointer = format!("{pointer}/mappings/{i}");
            used.push(optional_index(mapping, "material", "materials", materials, &pointer)?);
        }
        used.sort_unstable();
        used.dedup();
    }
    let mut tex_coords = BTreeMap::new();
    for name in attributes.as_object().into_iter().flat_map(|object| object.keys()) {
        let set = name.strip_prefix("TEXCOORD_").and_then(|set| set.parse().ok());
        if let (Some(set), Some(accessor)) = (set, attribute(name)?) {
            tex_coords.insert(set, accessor);
        }
    }
    let (color, normal) = (attribute("COLOR_0")?, attribute("NORMAL")?);
    let materials = used;
    Ok(Some(Primitive {
        pointer,
        topology,
        position,
        indices,
        materials,
        color,
        material,
        normal,
        tex_coords,
    }))
}
