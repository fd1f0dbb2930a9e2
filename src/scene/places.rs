//! Which vertices of an accessor a mesh uses, and where it puts them.

use std::collections::HashMap;

/// Places of an accessor's vertices in a mesh. Files that put all vertices into one accessor share it between many
/// meshes: a table of its full length for each would take time and memory quadratic in the file.
#[derive(Debug)]
pub(crate) enum Places {
    /// One place for each vertex.
    Table(Vec<u32>),
    /// Places of the vertices in use.
    Map(HashMap<u32, u32>),
}

const NO_PLACE: u32 = u32::MAX;

/// Accessors up to this length, or in use by one mesh only, get a table.
const SMALL: usize = 1 << 12;

impl Places {
    /// No vertex of an accessor of `count` vertices is in use yet; `is_shared`: other meshes use it too.
    pub(crate) fn new(count: usize, is_shared: bool) -> Places {
        if is_shared && count > SMALL {
            Places::Map(HashMap::new())
        } else {
            Places::Table(vec![NO_PLACE; count])
        }
    }

    /// The place of a vertex (in range), `next` on its first use, and whether this is it; `None` if the mesh is full.
    pub(crate) fn place(&mut self, vertex: u32, next: usize) -> Option<(u32, bool)> {
        let slot = match self {
            Places::Table(table) => &mut table[vertex as usize],
            Places::Map(map) => map.entry(vertex).or_insert(NO_PLACE),
        };
        let is_new = *slot == NO_PLACE;
        if is_new {
            *slot = u32::try_from(next).ok().filter(|&place| place != NO_PLACE)?;
        }
        Some((*slot, is_new))
    }
}
