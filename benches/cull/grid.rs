//! A million objects without baking them: ten by ten plants side by side, one tree with a hundred anchors, inside a tree
//! that sees all of them from everywhere. Files hold copies of a building like that.

use crate::Plant;
use glam::{DAffine3, DVec3, Vec3};
use svs_runtime::encode::{importance_code, level_bits_for, palette};
use svs_runtime::{Bounds, Nested, Placement, ProxyTables, SceneCuller, Tree, TreeTables, Visibility};

/// Plants along each side.
const SIDE: u32 = 10;
/// Distance of neighbours, in sizes.
const STEP: f32 = 1.1;

/// A culler for the grid, and the boxes of the plants in world space.
pub(crate) fn culler(plant: &Plant) -> (SceneCuller, Vec<Bounds>) {
    let whole = plant
        .bounds
        .iter()
        .fold(plant.bounds[0], |whole, b| Bounds { min: whole.min.min(b.min), max: whole.max.max(b.max) });
    let step = (whole.max - whole.min) * STEP;
    let offset = |cell: u32| Vec3::new((cell % SIDE) as f32, 0.0, (cell / SIDE) as f32) * step;
    let cells: Vec<Bounds> = (0..SIDE * SIDE)
        .map(|cell| Bounds { min: whole.min + offset(cell), max: whole.max + offset(cell) })
        .collect();
    let inner = rebuilt(&plant.tree, Placement::Anchors((0..SIDE * SIDE).collect()), None);
    let visibility = Visibility::new(vec![outer(&cells), inner]).expect("trees that fit each other");
    let mut culler = SceneCuller::new(&visibility, &[&cells, &plant.bounds]).expect("a box for each object");
    for cell in 0..SIDE * SIDE {
        culler.set_anchor(1, cell, DAffine3::from_translation(offset(cell).as_dvec3()));
    }
    (culler, cells)
}

/// One sphere around all cells, which sees each of them from all sides.
fn outer(cells: &[Bounds]) -> Tree {
    let (first, last) = (cells[0], cells[cells.len() - 1]);
    let (middle, radius) = ((first.min + last.max) * 0.5, (last.max - first.min).length() * 0.5);
    let count = cells.len() as u32;
    let size = (first.max - first.min).as_dvec3();
    let area = size.dot(DVec3::new(size.y, size.z, size.x));
    Tree::new(TreeTables {
        placement: Placement::Scene(0),
        directions: "octahedron".to_owned(),
        object_count: count,
        node_sphere: vec![[middle.x, middle.y, middle.z, radius]],
        node_subtree: vec![1],
        node_first_object: vec![0],
        node_object_count: vec![count],
        object_order: None,
        level_bits: 1,
        level_row: vec![0b11_1111; cells.len()],
        level_row_index: None,
        importance_area: area,
        importance: vec![0; cells.len()],
        proxies: None,
        nested: (0..count).map(|cell| Nested { object: cell, tree: 1, anchor: cell }).collect(),
        recommended_quality: None,
        fingerprint: None,
    })
    .expect("a valid tree")
}

/// A proxy for each node of a tree, with spheres that hold each other, errors of a hundredth of their radii, and at most 2,000
/// triangles; and how many those are.
pub(crate) fn proxies(tree: &Tree, bounds: &[Bounds], triangles: &[u32]) -> (ProxyTables, Vec<u32>) {
    let nodes = tree.nodes();
    let mut spheres: Vec<(Vec3, f32)> = nodes
        .iter()
        .map(|node| {
            let objects = &bounds[node.objects().start as usize..node.objects().end as usize];
            let far =
                |b: &Bounds| (b.max - node.center).abs().max((b.min - node.center).abs()).length() * 1.0001;
            (node.center, objects.iter().map(far).fold(0.0, f32::max))
        })
        .collect();
    let mut open: Vec<usize> = Vec::new();
    let parents: Vec<Option<usize>> = nodes
        .iter()
        .enumerate()
        .map(|(index, node)| {
            open.truncate(node.depth as usize);
            open.push(index);
            open.len().checked_sub(2).map(|parent| open[parent])
        })
        .collect();
    for (index, parent) in parents.into_iter().enumerate().rev() {
        if let Some(parent) = parent {
            let reach = spheres[parent].0.distance(spheres[index].0) + spheres[index].1 * 1.0001;
            spheres[parent].1 = spheres[parent].1.max(reach);
        }
    }
    let counts = nodes.iter().map(|node| {
        let objects = &triangles[node.objects().start as usize..node.objects().end as usize];
        (objects.iter().sum::<u32>() / 4).clamp(1, 2000)
    });
    let tables = ProxyTables {
        visible: true,
        sphere: spheres.iter().map(|(center, radius)| center.extend(*radius).to_array()).collect(),
        subtree: nodes.iter().map(|node| node.subtree).collect(),
        first_object: nodes.iter().map(|node| node.first_object).collect(),
        object_count: nodes.iter().map(|node| node.object_count).collect(),
        object: None,
        error: spheres.iter().map(|(_, radius)| radius * 0.01).collect(),
        deviation: None,
        mesh: vec![0; nodes.len()],
        origin: vec![[0.0; 3]; nodes.len()],
    };
    (tables, counts.collect())
}

/// The same tree elsewhere.
pub(crate) fn rebuilt(tree: &Tree, placement: Placement, proxies: Option<ProxyTables>) -> Tree {
    let (objects, directions) = (tree.object_count(), tree.direction_set().len());
    let levels: Vec<u8> =
        (0..objects).flat_map(|object| (0..directions).map(move |d| tree.level(object, d))).collect();
    let areas: Vec<f64> = (0..objects)
        .flat_map(|object| {
            (1..=u32::from(tree.max_level(object))).map(move |height| tree.importance_area(object, height))
        })
        .map(f64::from)
        .collect();
    let importance_area = areas.iter().copied().fold(0.0, f64::max);
    let level_bits = level_bits_for(levels.iter().copied().max().unwrap_or(0));
    let rows = palette(&levels, directions, level_bits);
    let nodes = tree.nodes();
    Tree::new(TreeTables {
        placement,
        directions: tree.direction_set().name().to_owned(),
        object_count: objects as u32,
        node_sphere: nodes.iter().map(|n| [n.center.x, n.center.y, n.center.z, n.radius]).collect(),
        node_subtree: nodes.iter().map(|n| n.subtree).collect(),
        node_first_object: nodes.iter().map(|n| n.first_object).collect(),
        node_object_count: nodes.iter().map(|n| n.object_count).collect(),
        object_order: None,
        level_bits,
        level_row: rows.rows,
        level_row_index: rows.index,
        importance_area,
        importance: areas.iter().map(|&area| importance_code(area, importance_area)).collect(),
        proxies,
        nested: Vec::new(),
        recommended_quality: None,
        fingerprint: None,
    })
    .expect("a valid tree")
}
