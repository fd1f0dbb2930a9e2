//! The proxies that are stored, as tables of the extension.

use super::build::{Built, children};
use super::geometry::{Fidelity, ProxyGeometry};
use super::hierarchy::ProxyHierarchy;
use crate::bake::encode::{EncodedTable, floats, integers};
use crate::bake::prune;
use crate::bake::subject::Subject;
use crate::bake::tree::{Hierarchy, Sphere};
use glam::{DVec3, Vec3};

/// One stored proxy: a row of the tables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) sphere: [f32; 4],
    pub(super) subtree: u32,
    pub(super) first_object: u32,
    pub(super) object_count: u32,
    pub(super) error: f32,
    /// Mean, root mean square, share that looks wrong.
    pub(super) deviation: [f32; 3],
    /// Node (an original) and level whose geometry it is.
    pub(super) content: (u32, usize),
    pub(super) origin: Vec3,
    pub(super) depth: u32,
    pub(super) triangles: usize,
}

/// Rows in depth-first order, and the members (document order) in proxy order.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    pub(super) rows: Vec<Row>,
    pub(super) order: Vec<u32>,
}

/// Makes the rows of the nodes of which levels are kept: `kept[node]` are the levels of an original, finest first.
pub(super) fn rows(
    subject: &Subject,
    tree: &ProxyHierarchy,
    built: &Built,
    spheres: &[Sphere],
    kept: &[Vec<usize>],
) -> Rows {
    let levels_of = |node: usize| &kept[tree.original[node] as usize];
    let keep: Vec<bool> = (0..tree.hierarchy.nodes.len())
        .map(|node| !built.redundant[node] && !levels_of(node).is_empty())
        .collect();
    let nodes: Vec<usize> = (0..keep.len()).filter(|&node| keep[node]).collect();
    // Kept nodes stay in depth-first order, so `nodes` stays in step.
    let hierarchy = prune::without_dropped(&tree.hierarchy, &keep);
    let mut sizes = vec![0u32; nodes.len()];
    for (place, node) in hierarchy.nodes.iter().enumerate().rev() {
        sizes[place] += levels_of(nodes[place]).len() as u32;
        if let Some(parent) = node.parent {
            sizes[parent as usize] += sizes[place];
        }
    }
    let spheres = nested_spheres(&hierarchy, &nodes, subject, tree, built, spheres, kept);
    let mut rows: Vec<Row> = Vec::new();
    let mut parents: Vec<Option<usize>> = Vec::new();
    let mut last_row = vec![0; nodes.len()];
    for (place, node) in hierarchy.nodes.iter().enumerate() {
        let original = tree.original[nodes[place]] as usize;
        let origin = built.origins[nodes[place]].as_vec3();
        // The place of a copy may not be one that f32 can tell.
        let rounding = built.origins[nodes[place]].distance(origin.as_dvec3());
        let mut parent = node.parent.map(|parent| last_row[parent as usize]);
        for (above, &level) in levels_of(nodes[place]).iter().rev().enumerate() {
            let geometry = &built.levels[original][level];
            parents.push(parent);
            parent = Some(rows.len());
            rows.push(Row {
                sphere: spheres[place],
                subtree: sizes[place] - above as u32,
                first_object: node.members.start,
                object_count: node.members.end - node.members.start,
                error: up(geometry.error + rounding),
                deviation: deviation(&geometry.fidelity, rounding, geometry.error + rounding),
                content: (original as u32, level),
                origin,
                depth: parents[rows.len()].map_or(0, |parent| rows[parent].depth + 1),
                triangles: geometry.triangles,
            });
        }
        last_row[place] = rows.len() - 1;
    }
    for row in (0..rows.len()).rev() {
        if let Some(parent) = parents[row] {
            rows[parent].error = rows[parent].error.max(rows[row].error);
        }
    }
    Rows { rows, order: hierarchy.order }
}

/// Spheres about originals, proxies and the spheres of the children, as they are stored.
fn nested_spheres(
    hierarchy: &Hierarchy,
    nodes: &[usize],
    subject: &Subject,
    tree: &ProxyHierarchy,
    built: &Built,
    spheres: &[Sphere],
    kept: &[Vec<usize>],
) -> Vec<[f32; 4]> {
    let mut stored = vec![[0.0f32; 4]; nodes.len()];
    for (place, &node) in nodes.iter().enumerate().rev() {
        let own = &spheres[node];
        let original = tree.original[node] as usize;
        let origin = built.origins[node].as_vec3().as_dvec3();
        let children = children(&hierarchy.nodes, place);
        let mut balls: Vec<(DVec3, f64)> = children
            .iter()
            .map(|&child| {
                let [x, y, z, radius] = stored[child as usize].map(f64::from);
                (DVec3::new(x, y, z), radius)
            })
            .collect();
        let reaches = |center: DVec3, balls: &[(DVec3, f64)]| {
            let proxies =
                kept[original].iter().map(|&level| reach(&built.levels[original][level], origin - center));
            let below = balls.iter().map(|(at, radius)| center.distance(*at) + radius);
            proxies.chain(below).fold(0.0, f64::max)
        };
        // About the smallest sphere of the originals; or, if that is smaller, about that of the children's spheres.
        let mut center = own.center.as_vec3().as_dvec3();
        let mut radius = reaches(center, &balls).max(own.radius);
        if let Some(&first) = children.first() {
            let direct = hierarchy.nodes[place].members.start..hierarchy.nodes[first as usize].members.start;
            for member in direct.map(|place| hierarchy.order[place as usize]) {
                let bounds = subject.members[member as usize].bounds;
                balls.push((bounds.center(), (bounds.max - bounds.min).length() * 0.5));
            }
            let other = center_of(&balls, center).as_vec3().as_dvec3();
            let about_other = reaches(other, &balls);
            if about_other < radius {
                (center, radius) = (other, about_other);
            }
        }
        // Room for the rounding of those who check it in f32.
        let radius = up(radius + 1e-6 * (radius + center.length() * 1e-6));
        let center = center.as_vec3();
        stored[place] = [center.x, center.y, center.z, radius];
    }
    stored
}

/// Steps towards the centre of the smallest ball of balls; the error falls as one over their number.
const STEPS: u32 = 64;

/// About the centre of the smallest ball that holds `balls`: Badoiu and Clarkson, Smaller Core-Sets for Balls, 2003.
fn center_of(balls: &[(DVec3, f64)], start: DVec3) -> DVec3 {
    let mut center = start;
    for step in 1..=STEPS {
        let reach = |(at, radius): &(DVec3, f64)| center.distance(*at) + radius;
        let Some((at, radius)) = balls.iter().max_by(|a, b| reach(a).total_cmp(&reach(b))) else { break };
        let away = (*at - center).normalize_or_zero();
        center += (*at + away * *radius - center) / f64::from(step + 1);
    }
    center
}

/// Largest distance of a vertex from a point; `shift` leads from it to the proxy's origin.
fn reach(geometry: &ProxyGeometry, shift: DVec3) -> f64 {
    let positions = geometry.classes.iter().flat_map(|mesh| &mesh.positions);
    positions.map(|&p| (Vec3::from_array(p).as_dvec3() + shift).length()).fold(0.0, f64::max)
}

/// As it is stored: the mean is at most the root mean square, and that is at most the error.
pub(super) fn deviation(fidelity: &Fidelity, rounding: f64, error: f64) -> [f32; 3] {
    let error = error.min(f64::from(f32::MAX));
    let rms = (fidelity.rms + rounding).min(error) as f32;
    // Rounded down, where it is the error.
    let rms = if f64::from(rms) > error { rms.next_down() } else { rms }.max(0.0);
    [((fidelity.mean + rounding).min(error) as f32).min(rms), rms, fidelity.wrong.clamp(0.0, 1.0) as f32]
}

/// The nearest `f32` that is not smaller.
fn up(value: f64) -> f32 {
    let rounded = value as f32;
    let rounded = if f64::from(rounded) < value { rounded.next_up() } else { rounded };
    if rounded.is_finite() { rounded } else { f32::MAX }
}

/// The tables; `meshes[i]` is the glTF mesh of row `i`, `places[k]` the place in the tree's order of the k-th object in
/// proxy order.
pub(super) fn encode(rows: &[Row], meshes: &[u32], places: &[u32]) -> Vec<EncodedTable> {
    let mut tables = vec![
        floats("PROXY_SPHERE", "VEC4", rows.iter().flat_map(|row| row.sphere)),
        integers("PROXY_SUBTREE", rows.iter().map(|row| row.subtree)),
        integers("PROXY_FIRST_OBJECT", rows.iter().map(|row| row.first_object)),
        integers("PROXY_OBJECT_COUNT", rows.iter().map(|row| row.object_count)),
        floats("PROXY_ERROR", "SCALAR", rows.iter().map(|row| row.error)),
        floats("PROXY_DEVIATION", "VEC3", rows.iter().flat_map(|row| row.deviation)),
        integers("PROXY_MESH", meshes.iter().copied()),
        floats("PROXY_ORIGIN", "VEC3", rows.iter().flat_map(|row| row.origin.to_array())),
    ];
    if !places.iter().enumerate().all(|(k, &place)| k as u32 == place) {
        tables.push(integers("PROXY_OBJECT", places.iter().copied()));
    }
    tables
}
