//! Random but valid trees, and an encoder for them.
#![allow(dead_code, reason = "each test program uses a part of this")]

use glam::{DMat4, DVec3, Vec3};
use serde_json::{Value, json};
use svs_runtime::encode::{importance_code, level_bits_for, palette};
use svs_runtime::{
    AccessorSource, AccessorView, Bounds, Camera, Deviation, DirectionSet, Placement, ProxyTables, TreeTables,
};

/// splitmix64: the same numbers everywhere.
#[derive(Clone)]
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn point(&mut self, half: f64) -> DVec3 {
        DVec3::new(self.unit() - 0.5, self.unit() - 0.5, self.unit() - 0.5) * 2.0 * half
    }
}

/// A valid tree over random boxes within about ±12 m, with the boxes in tree order.
pub(crate) struct Sample {
    pub(crate) tables: TreeTables,
    pub(crate) bounds: Vec<Bounds>,
}

pub(crate) const SETS: [&str; 4] = ["dodecahedron", "icosahedron-1", "tetrahedron-2", "octahedron-2"];

struct Builder {
    random: Random,
    tables: TreeTables,
    bounds: Vec<Bounds>,
    depths: Vec<u32>,
}

impl Builder {
    fn object(&mut self, center: DVec3, reach: f64, depth: u32) {
        let center = (center + self.random.point(reach)).as_vec3();
        let half = Vec3::new(
            0.05 + self.random.unit() as f32,
            0.05 + self.random.unit() as f32,
            0.05 + self.random.unit() as f32,
        ) * 0.4;
        self.bounds.push(Bounds { min: center - half, max: center + half });
        self.depths.push(depth);
    }

    fn node(&mut self, center: DVec3, reach: f64, depth: u32) {
        let index = self.tables.node_sphere.len();
        let first = self.bounds.len();
        self.tables.node_sphere.push([0.0; 4]);
        self.tables.node_subtree.push(0);
        self.tables.node_first_object.push(first as u32);
        self.tables.node_object_count.push(0);
        for _ in 0..self.random.below(4) + usize::from(depth == 4) * 2 {
            self.object(center, reach, depth + 1);
        }
        if depth < 4 {
            for _ in 0..self.random.below(4) {
                let child = center + self.random.point(reach);
                self.node(child, reach * 0.4, depth + 1);
            }
        }
        // A sphere that holds all boxes, or, as around round things, only most of them.
        let boxes = &self.bounds[first..];
        let middle = boxes.iter().map(|b| (b.min + b.max) * 0.5).sum::<Vec3>() / boxes.len().max(1) as f32;
        let far = |b: &Bounds| (b.max - middle).abs().max((b.min - middle).abs()).length();
        let radius = boxes.iter().map(far).fold(0.0, f32::max) * [1.0001, 0.7][self.random.below(2)];
        self.tables.node_sphere[index] = [middle.x, middle.y, middle.z, radius];
        self.tables.node_subtree[index] = (self.tables.node_sphere.len() - index) as u32;
        self.tables.node_object_count[index] = (self.bounds.len() - first) as u32;
    }
}

/// Levels are random, or (`all_visible`) as high as they can be.
pub(crate) fn sample(seed: u64, all_visible: bool) -> Sample {
    let mut random = Random(seed);
    let directions = SETS[random.below(SETS.len())];
    let tables = TreeTables {
        placement: Placement::Scene(0),
        directions: directions.to_owned(),
        object_count: 0,
        node_sphere: Vec::new(),
        node_subtree: Vec::new(),
        node_first_object: Vec::new(),
        node_object_count: Vec::new(),
        object_order: None,
        level_bits: 1,
        level_row: Vec::new(),
        level_row_index: None,
        importance_area: 4.0,
        importance: Vec::new(),
        proxies: None,
        nested: Vec::new(),
        recommended_quality: Some(0.5),
        fingerprint: None,
    };
    let mut builder = Builder { random, tables, bounds: Vec::new(), depths: Vec::new() };
    for _ in 0..1 + builder.random.below(3) {
        for _ in 0..builder.random.below(3) {
            builder.object(DVec3::ZERO, 10.0, 0);
        }
        let center = builder.random.point(8.0);
        builder.node(center, 4.0, 0);
    }
    builder.object(DVec3::ZERO, 10.0, 0);
    let Builder { mut random, mut tables, bounds, depths } = builder;
    let count = DirectionSet::by_name(directions).unwrap().len();
    let mut levels = Vec::new();
    for &depth in &depths {
        let most = if all_visible { depth as usize } else { random.below(depth as usize + 1) };
        let seldom = random.below(4);
        let row: Vec<u8> = (0..count)
            .map(|_| if all_visible { most } else { random.below(most + 1 + seldom).min(most) })
            .map(|level| level as u8)
            .collect();
        let highest = *row.iter().max().unwrap();
        // Areas fall with height, as they do in real data.
        let mut area = tables.importance_area * random.unit();
        for _ in 0..highest {
            tables.importance.push(importance_code(area, tables.importance_area));
            area *= random.unit();
        }
        levels.extend(row);
    }
    tables.object_count = bounds.len() as u32;
    tables.level_bits = level_bits_for(*levels.iter().max().unwrap());
    let palette = palette(&levels, count, tables.level_bits);
    (tables.level_row, tables.level_row_index) = (palette.rows, palette.index);
    Sample { tables, bounds }
}

/// A camera somewhere around the origin, looking somewhere near it.
pub(crate) fn camera(seed: u64) -> Camera {
    let mut random = Random(seed);
    let distance = [3.0, 10.0, 20.0, 60.0][random.below(4)];
    let eye = random.point(distance);
    Camera::perspective(view(eye, random.point(8.0)), 60_f64.to_radians(), 1280.0, 720.0, 0.05)
}

/// A camera in or near one of the boxes.
pub(crate) fn camera_at(bounds: &Bounds, seed: u64) -> Camera {
    let mut random = Random(seed);
    let half = (bounds.max - bounds.min).length() * 0.6;
    let eye = (bounds.min + bounds.max).as_dvec3() * 0.5 + random.point(f64::from(half));
    Camera::perspective(view(eye, random.point(8.0)), 60_f64.to_radians(), 1280.0, 720.0, 0.05)
}

pub(crate) fn view(eye: DVec3, target: DVec3) -> DMat4 {
    glam::dcamera::rh::view::look_at_mat4(eye, target, DVec3::new(0.1, 0.9, 0.2).normalize())
}

/// Accessors held in memory.
#[derive(Clone, Default, Debug)]
pub(crate) struct Accessors(pub(crate) Vec<(Vec<u8>, u32, u32, usize)>);

impl AccessorSource for Accessors {
    fn accessor(&self, index: usize) -> Option<AccessorView<'_>> {
        let (bytes, component_type, components, count) = self.0.get(index)?;
        let (component_type, components, count) = (*component_type, *components, *count);
        Some(AccessorView { bytes, component_type, components, count })
    }
}

impl Accessors {
    fn add(&mut self, bytes: Vec<u8>, component_type: u32, components: u32, count: usize) -> usize {
        self.0.push((bytes, component_type, components, count));
        self.0.len() - 1
    }

    fn integers(&mut self, values: &[u32]) -> usize {
        let (bytes, component_type) = match values.iter().max() {
            Some(0..=0xFF) => (values.iter().map(|&v| v as u8).collect(), 5121),
            Some(0..=0xFFFF) => (values.iter().flat_map(|&v| (v as u16).to_le_bytes()).collect(), 5123),
            _ => (values.iter().flat_map(|&v| v.to_le_bytes()).collect(), 5125),
        };
        self.add(bytes, component_type, 1, values.len())
    }

    fn bytes(&mut self, values: &[u8]) -> usize {
        self.add(values.to_vec(), 5121, 1, values.len())
    }
}

/// Writes one tree the way a baker does.
pub(crate) fn encode(tables: &TreeTables, accessors: &mut Accessors) -> Value {
    let spheres = tables.node_sphere.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let mut names = json!({
        "NODE_SPHERE": accessors.add(spheres, 5126, 4, tables.node_sphere.len()),
        "NODE_SUBTREE": accessors.integers(&tables.node_subtree),
        "NODE_FIRST_OBJECT": accessors.integers(&tables.node_first_object),
        "NODE_OBJECT_COUNT": accessors.integers(&tables.node_object_count),
        "LEVEL_ROW": accessors.bytes(&tables.level_row),
        "IMPORTANCE": accessors.bytes(&tables.importance),
    });
    if let Some(index) = &tables.level_row_index {
        names["LEVEL_ROW_INDEX"] = json!(accessors.integers(index));
    }
    if let Some(order) = &tables.object_order {
        names["OBJECT_ORDER"] = json!(accessors.integers(order));
    }
    let mut tree = json!({
        "directions": tables.directions,
        "objectCount": tables.object_count,
        "levelBits": tables.level_bits,
        "importanceArea": tables.importance_area,
        "tables": names,
    });
    match &tables.placement {
        Placement::Scene(scene) => tree["scene"] = json!(scene),
        Placement::Anchors(nodes) => tree["anchors"] = json!(nodes),
    }
    if !tables.nested.is_empty() {
        let nested = tables.nested.iter();
        tree["nested"] = nested
            .map(|n| json!({"object": n.object, "tree": n.tree, "anchor": n.anchor}))
            .collect::<Vec<_>>()
            .into();
    }
    if let Some(proxies) = &tables.proxies {
        tree["proxies"] = encode_proxies(proxies, accessors);
    }
    if let Some(quality) = tables.recommended_quality {
        tree["recommended"] = json!({ "quality": quality });
    }
    tree
}

fn encode_proxies(proxies: &ProxyTables, accessors: &mut Accessors) -> Value {
    let floats = |values: &mut dyn Iterator<Item = &f32>| values.flat_map(|v| v.to_le_bytes()).collect();
    let count = proxies.sphere.len();
    let mut names = json!({
        "PROXY_SPHERE": accessors.add(floats(&mut proxies.sphere.iter().flatten()), 5126, 4, count),
        "PROXY_SUBTREE": accessors.integers(&proxies.subtree),
        "PROXY_FIRST_OBJECT": accessors.integers(&proxies.first_object),
        "PROXY_OBJECT_COUNT": accessors.integers(&proxies.object_count),
        "PROXY_ERROR": accessors.add(floats(&mut proxies.error.iter()), 5126, 1, count),
        "PROXY_MESH": accessors.integers(&proxies.mesh),
        "PROXY_ORIGIN": accessors.add(floats(&mut proxies.origin.iter().flatten()), 5126, 3, count),
    });
    if let Some(deviation) = &proxies.deviation {
        let rows: Vec<f32> = deviation.iter().flat_map(|d| [d.mean, d.rms, d.wrong]).collect();
        names["PROXY_DEVIATION"] = json!(accessors.add(floats(&mut rows.iter()), 5126, 3, count));
    }
    if let Some(object) = &proxies.object {
        names["PROXY_OBJECT"] = json!(accessors.integers(object));
    }
    json!({"visible": proxies.visible, "tables": names})
}

/// A root with two proxies below it over all objects but the first, in reverse order.
pub(crate) fn some_proxies(object_count: u32) -> ProxyTables {
    let rest = object_count - 1;
    ProxyTables {
        visible: true,
        sphere: vec![[0.0, 0.0, 0.0, 30.0], [1.0, 0.0, 0.0, 20.0], [-1.0, 0.0, 0.0, 20.0]],
        subtree: vec![3, 1, 1],
        first_object: vec![1, 1, 1 + rest / 2],
        object_count: vec![rest, rest / 2, rest - rest / 2],
        object: Some((0..object_count).rev().collect()),
        error: vec![0.5, 0.1, 0.2],
        deviation: Some(
            [0.25, 0.0, 0.1].map(|mean| Deviation { mean, rms: mean * 2.0, wrong: mean }).to_vec(),
        ),
        mesh: vec![9, 10, 10],
        origin: vec![[0.0; 3], [1.0, 2.0, 3.0], [0.0; 3]],
    }
}

pub(crate) fn extension(trees: Vec<Value>) -> Value {
    json!({"version": "1.0", "generator": "test", "trees": trees})
}
