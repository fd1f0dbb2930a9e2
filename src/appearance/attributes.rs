//! Vertex attributes: which are usable, and those that several meshes share, decoded once.

use super::materials::Materials;
use crate::gltf::{AccessorKind, Document};
use crate::parallel;
use crate::scene::notes::Notes;
use crate::scene::primitives::{Plan, Primitive};
use glam::Vec4;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Elements of an accessor, filled up with zeros, the fourth component with one.
pub(super) type Elements = Arc<Vec<Vec4>>;

/// Attributes beyond the positions may have this many elements in all plus 64 for each byte of the file: more would come
/// from many accessors over the same bytes.
const FREE_ELEMENTS: u64 = 1 << 24;

/// The accessors of one primitive's attributes, those that are left out being `None`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Choice {
    pub(super) normal: Option<usize>,
    pub(super) color: Option<usize>,
    pub(super) uv: Option<usize>,
}

#[derive(Debug)]
pub(super) struct Attributes {
    /// Accessors that several meshes use.
    shared: BTreeMap<usize, Elements>,
    /// Accessors that are left out, lest they fill the memory.
    refused: BTreeSet<usize>,
}

impl Attributes {
    /// Nothing decoded, nothing refused.
    pub(super) fn plain() -> Self {
        Self { shared: BTreeMap::new(), refused: BTreeSet::new() }
    }

    /// Looks at all attributes of the plan and decodes what meshes share.
    pub(super) fn read(doc: &Document, plan: &Plan, materials: &Materials, notes: &mut Notes) -> Self {
        let mut attributes = Self::plain();
        let mut user: BTreeMap<usize, usize> = BTreeMap::new();
        let mut shared = BTreeSet::new();
        let mut elements_left = doc.described_bytes().saturating_mul(64).saturating_add(FREE_ELEMENTS);
        for (m, mesh) in plan.meshes.iter().enumerate() {
            for primitive in &mesh.primitives {
                let choice = attributes.choose(doc, primitive, materials, notes);
                for accessor in [choice.normal, choice.color, choice.uv].into_iter().flatten() {
                    let first = *user.entry(accessor).or_insert_with(|| {
                        let count = doc.accessor(accessor).map_or(0, |accessor| accessor.count as u64);
                        match elements_left.checked_sub(count) {
                            Some(left) => elements_left = left,
                            None => {
                                attributes.refused.insert(accessor);
                                notes.add("ATTRIBUTES_TOO_LARGE", "vertex attributes are too large for a file of this size and are left out", || primitive.pointer.clone());
                            }
                        }
                        m
                    });
                    if first != m && !attributes.refused.contains(&accessor) {
                        shared.insert(accessor);
                    }
                }
            }
        }
        // The plan has bounded the positions.
        shared.extend(plan.shared_positions.keys());
        let shared: Vec<usize> = shared.into_iter().collect();
        let decoded = parallel::map(&shared, |&accessor| Some((accessor, decode(doc, accessor)?)));
        attributes.shared = decoded.into_iter().flatten().collect();
        attributes
    }

    /// The attributes that a primitive is drawn with.
    pub(super) fn choose(
        &self,
        doc: &Document,
        primitive: &Primitive,
        materials: &Materials,
        notes: &mut Notes,
    ) -> Choice {
        let count = doc.accessor(primitive.position).map_or(0, |accessor| accessor.count);
        let mut usable = |accessor: Option<usize>, kinds: &[AccessorKind]| {
            let accessor = accessor.filter(|accessor| !self.refused.contains(accessor))?;
            let fits = |found: crate::gltf::Accessor<'_>| found.count == count && kinds.contains(&found.kind);
            if doc.accessor(accessor).is_ok_and(fits) {
                return Some(accessor);
            }
            let message = "vertex attributes have another length than their positions, or the wrong type";
            notes.add("ATTRIBUTE_UNUSABLE", message, || primitive.pointer.clone());
            None
        };
        let normal = usable(primitive.normal, &[AccessorKind::Vec3]);
        let color = usable(primitive.color, &[AccessorKind::Vec3, AccessorKind::Vec4]);
        let mapping = materials.mapping(primitive.material);
        let uv = mapping
            .and_then(|(set, _)| usable(primitive.tex_coords.get(&set).copied(), &[AccessorKind::Vec2]));
        if mapping.is_some() && uv.is_none() {
            let message = "primitives with a texture have no usable texture coordinates: drawn without";
            notes.add("TEXTURE_WITHOUT_UV", message, || primitive.pointer.clone());
        }
        Choice { normal, color, uv }
    }

    /// Whether several meshes use an accessor.
    pub(super) fn is_shared(&self, accessor: usize) -> bool {
        self.shared.contains_key(&accessor)
    }

    /// The elements of an accessor; decoded here unless several meshes share them. `None` if they cannot be read.
    pub(super) fn elements(&self, doc: &Document, accessor: usize) -> Option<Elements> {
        self.shared.get(&accessor).cloned().or_else(|| decode(doc, accessor))
    }
}

fn decode(doc: &Document, accessor: usize) -> Option<Elements> {
    let accessor = doc.accessor(accessor).ok()?;
    let elements: Vec<Vec4> = match accessor.kind {
        AccessorKind::Vec2 => {
            let vectors = accessor.read_vec2_f32().ok()?;
            vectors.into_iter().map(|v| Vec4::new(v.x, v.y, 0.0, 1.0)).collect()
        }
        AccessorKind::Vec3 => {
            let vectors = accessor.read_vec3_f64().ok()?;
            vectors.into_iter().map(|v| v.as_vec3().extend(1.0)).collect()
        }
        AccessorKind::Vec4 => accessor.read_vec4_f32().ok()?,
        _ => return None,
    };
    Some(Arc::new(elements))
}
