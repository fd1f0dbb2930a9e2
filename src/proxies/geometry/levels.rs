//! Simplified versions of one mesh, each of the one before.

use super::class::Class;
use super::fidelity::Fidelity;
use super::measure::Reference;
use super::node::choose;
use super::soup::Soup;
use super::weld::weld;
use svs_render::{Mesh, Primitive};

/// How levels are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelOptions {
    /// Triangles of a level as a share of those before it, above 0 and below 1.
    pub share: f64,
    /// No level has fewer triangles than this.
    pub least_triangles: usize,
    /// No more levels than this.
    pub most_levels: usize,
    /// A level with a larger error than this share of the mesh's diagonal does not pay.
    pub largest_error: f64,
    /// Points of each surface that the error is measured with (area samples, and as many vertices).
    pub samples: usize,
}

impl Default for LevelOptions {
    fn default() -> Self {
        Self { share: 0.25, least_triangles: 12, most_levels: 8, largest_error: 0.2, samples: 2000 }
    }
}

/// One simplified version of a mesh.
#[derive(Clone, Debug)]
pub struct MeshLevel {
    /// Its triangles, with the materials of the original.
    pub mesh: Mesh,
    /// Largest measured distance between it and the original, metres of mesh space.
    pub error: f64,
    /// By area, in the same space.
    pub fidelity: Fidelity,
    /// Number of triangles.
    pub triangles: usize,
}

/// Simplified versions of a mesh, with rising errors and falling numbers of triangles. Primitives keep their materials,
/// normals, colours and texture coordinates. None if nothing is gained.
pub fn simplify_mesh_levels(mesh: &Mesh, options: &LevelOptions) -> Vec<MeshLevel> {
    let mut levels: Vec<MeshLevel> = Vec::new();
    let mut current = weld(&soup_of(mesh), 0.0);
    let mut before = current.triangle_count();
    let share = if options.share > 0.0 && options.share < 1.0 { options.share } else { 0.25 };
    if (before as f64 * share) < options.least_triangles as f64 {
        return levels;
    }
    let reference = Reference::of_soup(&current, options.samples);
    let largest = options.largest_error * reference.diagonal();
    while levels.len() < options.most_levels {
        let target = (before as f64 * share) as usize;
        if target < options.least_triangles.max(1) {
            break;
        }
        let (reduced, _) = choose(&current, target, &reference);
        let triangles = reduced.triangle_count();
        // Half way to the wanted share is the least that is worth its bytes.
        let worth = triangles as f64 <= before as f64 * (1.0 + share) * 0.5;
        if triangles == 0 || !worth {
            break;
        }
        let (max, fidelity) = reference.compare(&reduced, None);
        if max > largest {
            break;
        }
        let error = levels.last().map_or(0.0, |level| level.error).max(max);
        levels.push(MeshLevel { mesh: mesh_of(&reduced, mesh), error, fidelity, triangles });
        before = triangles;
        current = weld(&reduced, 0.0);
    }
    levels
}

/// One class per primitive.
fn soup_of(mesh: &Mesh) -> Soup {
    let mut soup = Soup::default();
    for (class, primitive) in mesh.primitives.iter().enumerate() {
        let count = primitive.positions.len();
        let first = soup.positions.len() as u32;
        let flat = primitive.normals.len() != count;
        soup.classes.push(Class::Kept { material: primitive.material, flat });
        soup.positions.extend(&primitive.positions);
        soup.normals.extend(padded(&primitive.normals, count, [0.0; 3]));
        soup.colors.extend(padded(&primitive.colors, count, [255; 4]));
        soup.uvs.extend(padded(&primitive.uvs, count, [0.0; 2]));
        soup.vertex_class.extend(std::iter::repeat_n(class as u32, count));
        for corners in primitive.indices.chunks_exact(3) {
            let usable = |&v: &u32| {
                primitive.positions.get(v as usize).is_some_and(|p| p.iter().all(|c| c.is_finite()))
            };
            if corners.iter().all(usable) {
                soup.indices.extend(corners.iter().map(|v| v + first));
            }
        }
    }
    // Vertices that no triangle uses may be anything.
    for position in &mut soup.positions {
        if !position.iter().all(|c| c.is_finite()) {
            *position = [0.0; 3];
        }
    }
    soup.indices = soup.filtered(|t| soup.area(t) > 0.0);
    soup
}

fn padded<T: Copy>(values: &[T], count: usize, default: T) -> Vec<T> {
    if values.len() == count { values.to_vec() } else { vec![default; count] }
}

/// Primitives with the attributes that the original's have.
fn mesh_of(soup: &Soup, original: &Mesh) -> Mesh {
    let mut primitives: Vec<Primitive> = original
        .primitives
        .iter()
        .map(|primitive| Primitive { material: primitive.material, ..Primitive::default() })
        .collect();
    let mut places = vec![u32::MAX; soup.positions.len()];
    for triangle in 0..soup.triangle_count() {
        let class = soup.class(triangle);
        let (primitive, like) = (&mut primitives[class], &original.primitives[class]);
        let has = |length: usize| length == like.positions.len();
        for vertex in soup.corners(triangle).map(|v| v as usize) {
            if places[vertex] == u32::MAX {
                places[vertex] = primitive.positions.len() as u32;
                primitive.positions.push(soup.positions[vertex]);
                if has(like.normals.len()) {
                    primitive.normals.push(soup.normals[vertex]);
                }
                if has(like.colors.len()) {
                    primitive.colors.push(soup.colors[vertex]);
                }
                if has(like.uvs.len()) {
                    primitive.uvs.push(soup.uvs[vertex]);
                }
            }
            primitive.indices.push(places[vertex]);
        }
    }
    primitives.retain(|primitive| !primitive.indices.is_empty());
    Mesh { primitives }
}
