//! Makes a triangulation of points on the sphere Delaunay, by edge flips (Lawson 1977).
//!
//! On the sphere, Delaunay means: the triangles are the faces of the points' convex hull. Edge subdivision of
//! the tetrahedron does not keep this, and greedy walks need it to end at the true nearest direction.

use glam::DVec3;

/// Points nearer than this to a triangle's plane count as cocircular: their edge stays as it is.
const COCIRCULAR: f64 = 1e-12;

/// For each edge `(from, to)` of a counter-clockwise triangle, the index of that triangle: by `from` a list, which is as short
/// as vertices have neighbours.
pub(crate) struct EdgeMap(Vec<Vec<(u16, u32)>>);

impl EdgeMap {
    /// The edges of all triangles.
    pub(crate) fn new(triangles: &[[u16; 3]]) -> Self {
        let last = triangles.iter().flatten().max().map_or(0, |&vertex| usize::from(vertex));
        let mut map = Self(vec![Vec::new(); last + 1]);
        for (index, &[a, b, c]) in triangles.iter().enumerate() {
            for edge in [(a, b), (b, c), (c, a)] {
                map.insert(edge, index as u32);
            }
        }
        map
    }

    /// The triangle that has the edge.
    pub(crate) fn get(&self, (from, to): (u16, u16)) -> Option<u32> {
        let edges = self.0.get(usize::from(from))?;
        edges.iter().find(|(end, _)| *end == to).map(|&(_, triangle)| triangle)
    }

    fn insert(&mut self, (from, to): (u16, u16), triangle: u32) {
        self.remove((from, to));
        self.0[usize::from(from)].push((to, triangle));
    }

    fn remove(&mut self, (from, to): (u16, u16)) {
        self.0[usize::from(from)].retain(|(end, _)| *end != to);
    }
}

/// Flips edges until no vertex lies above the plane of a neighbouring triangle.
pub(crate) fn make_delaunay(vertices: &[DVec3], triangles: &mut [[u16; 3]]) {
    let mut edges = EdgeMap::new(triangles);
    let mut queue: Vec<(u16, u16)> =
        triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).filter(|(a, b)| a < b).collect();
    let mut next = 0;
    while let Some(&(a, b)) = queue.get(next) {
        next += 1;
        let (Some(left), Some(right)) = (edges.get((a, b)), edges.get((b, a))) else { continue };
        let c = opposite(triangles[left as usize], a, b);
        let d = opposite(triangles[right as usize], b, a);
        let [pa, pb, pc, pd] = [a, b, c, d].map(|i| vertices[i as usize]);
        let above = (pb - pa).cross(pc - pa).dot(pd - pa);
        if above <= COCIRCULAR {
            continue;
        }
        edges.remove((a, b));
        edges.remove((b, a));
        triangles[left as usize] = [a, d, c];
        triangles[right as usize] = [d, b, c];
        for (edge, triangle) in [
            ((a, d), left),
            ((d, c), left),
            ((c, a), left),
            ((d, b), right),
            ((b, c), right),
            ((c, d), right),
        ] {
            edges.insert(edge, triangle);
        }
        queue.extend([(a, d), (d, b), (b, c), (c, a)]);
    }
}

fn opposite(triangle: [u16; 3], a: u16, b: u16) -> u16 {
    triangle.into_iter().find(|&v| v != a && v != b).unwrap_or(a)
}
