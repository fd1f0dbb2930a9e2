//! Edge subdivision: every edge's midpoint is pushed to the sphere, every triangle becomes four.

use super::solid::{Mesh, unit};
use std::collections::HashMap;

/// One subdivision. Old vertices keep their indices, so the smaller set is a prefix of the larger one; midpoints
/// follow in the order in which the triangles' edges (first-second, second-third, third-first) meet them.
pub(crate) fn subdivide(mesh: &Mesh) -> Mesh {
    let mut vertices = mesh.vertices.clone();
    let mut triangles = Vec::with_capacity(mesh.triangles.len() * 4);
    let mut midpoints: HashMap<(u16, u16), u16> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
            *midpoints.entry((from.min(to), from.max(to))).or_insert_with(|| {
                let index = vertices.len() as u16;
                vertices.push(unit(vertices[from as usize] + vertices[to as usize]));
                index
            })
        });
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh { vertices, triangles }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::directions::solid::Solid;

    #[test]
    fn smaller_sets_are_prefixes() {
        let coarse = Solid::Icosahedron.mesh();
        let fine = subdivide(&coarse);
        assert_eq!(fine.vertices.len(), 42);
        assert_eq!(fine.triangles.len(), 80);
        assert_eq!(fine.vertices[..12], coarse.vertices[..]);
    }
}
