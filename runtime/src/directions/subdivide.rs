//! Edge subdivision: every edge's midpoint is pushed to the sphere, every triangle becomes four.

use super::solid::{Mesh, unit};

/// One subdivision. Old vertices keep their indices, so the smaller set is a prefix of the larger one; midpoints
/// follow in the order in which the triangles' edges (first-second, second-third, third-first) meet them.
pub(crate) fn subdivide(mesh: &Mesh) -> Mesh {
    let mut vertices = mesh.vertices.clone();
    let mut triangles = Vec::with_capacity(mesh.triangles.len() * 4);
    // For each vertex, the neighbours of higher index and the vertex between.
    let mut midpoints: Vec<Vec<(u16, u16)>> = vec![Vec::new(); vertices.len()];
    for &[a, b, c] in &mesh.triangles {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
            let (low, high) = (from.min(to), from.max(to));
            let known = &mut midpoints[low as usize];
            if let Some(&(_, index)) = known.iter().find(|(other, _)| *other == high) {
                return index;
            }
            let index = vertices.len() as u16;
            known.push((high, index));
            vertices.push(unit(vertices[from as usize] + vertices[to as usize]));
            index
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
