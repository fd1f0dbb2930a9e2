//! The bytes of the extension's tables, for the runtime's decoder.

use crate::gltf::Document;
use std::borrow::Cow;
use std::collections::BTreeMap;
use svs_runtime::format::Extension;
use svs_runtime::{AccessorSource, AccessorView};

/// The accessors that the trees of an extension name, each read once. Those that cannot be read are left out, and
/// the decoder says which it misses.
#[derive(Debug, Default)]
pub struct DocumentTables<'a> {
    accessors: BTreeMap<usize, Stored<'a>>,
}

#[derive(Debug)]
struct Stored<'a> {
    bytes: Cow<'a, [u8]>,
    component_type: u32,
    components: u32,
    count: usize,
}

impl<'a> DocumentTables<'a> {
    /// Reads the tables of `extension` from `doc`.
    pub fn new(doc: &'a Document, extension: &Extension) -> Self {
        let mut accessors = BTreeMap::new();
        for tree in &extension.trees {
            let t = &tree.tables;
            let nodes = [t.node_sphere, t.node_subtree, t.node_first_object, t.node_object_count];
            let objects = [t.object_order, t.level_row, t.level_row_index, t.importance];
            for index in nodes.into_iter().chain(objects).flatten() {
                let index = index as usize;
                if !accessors.contains_key(&index)
                    && let Some(stored) = read(doc, index)
                {
                    accessors.insert(index, stored);
                }
            }
        }
        Self { accessors }
    }
}

fn read(doc: &Document, index: usize) -> Option<Stored<'_>> {
    let accessor = doc.accessor(index).ok()?;
    Some(Stored {
        bytes: accessor.bytes()?,
        component_type: accessor.component_type.code(),
        components: accessor.kind.components() as u32,
        count: accessor.count,
    })
}

impl AccessorSource for DocumentTables<'_> {
    fn accessor(&self, index: usize) -> Option<AccessorView<'_>> {
        let Stored { bytes, component_type, components, count } = self.accessors.get(&index)?;
        let (component_type, components, count) = (*component_type, *components, *count);
        Some(AccessorView { bytes, component_type, components, count })
    }
}
