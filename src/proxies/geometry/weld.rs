//! Makes vertices one that are the same within a tolerance, so that the simplifier sees connected surfaces.

use super::class::Class;
use super::soup::Soup;
use glam::Vec3;
use std::collections::HashMap;

/// Normals closer than this (cosine) may be made one.
const SAME_NORMAL: f32 = 0.94;
/// Vertex colours closer than this per channel, of 255, may be made one.
const SAME_COLOR: u8 = 4;
/// Texture coordinates closer than this may be made one.
const SAME_UV: f32 = 1e-4;

/// Vertices that nearly coincide become one: the first of them. `tolerance` in metres; 0: only exact repetitions.
/// Triangles that lose their area this way and vertices that are not used are dropped.
pub(super) fn weld(soup: &Soup, tolerance: f32) -> Soup {
    let exact = !(tolerance > 0.0);
    // Wide cells: a vertex can only be near another of its own cell or of a neighbour on its side.
    let size = f64::from(tolerance) * 2.0;
    let mut cells: HashMap<([i64; 3], u32), Vec<u32>> = HashMap::new();
    let mut out = Soup { classes: soup.classes.clone(), ..Soup::default() };
    let mut places = vec![u32::MAX; soup.positions.len()];
    for triangle in 0..soup.triangle_count() {
        let corners = soup.corners(triangle).map(|vertex| {
            let vertex = vertex as usize;
            if places[vertex] != u32::MAX {
                return places[vertex];
            }
            let class = soup.vertex_class[vertex];
            let position = soup.positions[vertex];
            let at = position.map(|c| if exact { 0.0 } else { f64::from(c) / size });
            let own = if exact {
                // Adding +0.0 makes -0.0 and +0.0 one.
                position.map(|c| i64::from((c + 0.0).to_bits()))
            } else {
                at.map(|c| c.floor() as i64)
            };
            let neighbors = if exact { 1 } else { 8 };
            let mut found = None;
            for corner in 0..neighbors {
                let cell: [i64; 3] = std::array::from_fn(|axis| {
                    let step = if at[axis].fract().rem_euclid(1.0) < 0.5 { -1 } else { 1 };
                    if corner >> axis & 1 == 1 { own[axis].saturating_add(step) } else { own[axis] }
                });
                let same = |&&other: &&u32| is_same(soup, vertex, &out, other as usize, tolerance);
                found = cells.get(&(cell, class)).and_then(|list| list.iter().find(same).copied());
                if found.is_some() {
                    break;
                }
            }
            let place = found.unwrap_or_else(|| {
                let place = out.positions.len() as u32;
                out.positions.push(position);
                out.normals.push(soup.normals[vertex]);
                out.colors.push(soup.colors[vertex]);
                out.uvs.push(soup.uvs[vertex]);
                out.vertex_class.push(class);
                cells.entry((own, class)).or_default().push(place);
                place
            });
            places[vertex] = place;
            place
        });
        let [a, b, c] = corners;
        if a != b && b != c && c != a {
            out.indices.extend(corners);
        }
    }
    out
}

fn is_same(soup: &Soup, vertex: usize, out: &Soup, other: usize, tolerance: f32) -> bool {
    let apart = |a: [f32; 3], b: [f32; 3]| Vec3::from_array(a).distance(Vec3::from_array(b));
    let class = &soup.classes[soup.vertex_class[vertex] as usize];
    let (a, b) = (Vec3::from_array(soup.normals[vertex]), Vec3::from_array(out.normals[other]));
    apart(soup.positions[vertex], out.positions[other]) <= tolerance.max(0.0)
        && (class.is_flat() || a.dot(b) >= SAME_NORMAL)
        && soup.colors[vertex].iter().zip(out.colors[other]).all(|(&a, b)| a.abs_diff(b) <= SAME_COLOR)
        && (matches!(class, Class::Plain(_))
            || soup.uvs[vertex].iter().zip(out.uvs[other]).all(|(a, b)| (a - b).abs() <= SAME_UV))
}
