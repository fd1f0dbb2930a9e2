//! The shapes a city is made of. Walls and blinds are made for each number of floors that occurs.

use super::building::{BAYS, FLOOR, MAX_FLOORS};
use crate::generate::builder::{Builder, MeshId, ShapeId};
use crate::generate::paint::Paint;
use crate::generate::random::Random;
use crate::generate::shape::Shape;
use std::f64::consts::FRAC_1_SQRT_2;

/// Turns a sheet that faces +z to face +y.
pub(super) const UP: [f64; 4] = [-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2];

/// Variants of blinds for each number of floors.
const BLINDS: usize = 3;
/// A bay is 1 / BAYS of the wall's width; its window lies within these shares of the bay, and at this height
/// above the floor, metres.
const WINDOW: [f64; 4] = [0.2, 0.8, 0.9, 2.3];

/// All shapes of a city.
#[derive(Debug)]
pub(super) struct Kit {
    pub(super) ground: ShapeId,
    pub(super) tree: MeshId,
    pub(super) cuboid: ShapeId,
    pub(super) roof: ShapeId,
    /// Interior walls of one floor: x and z in shares of the building's footprint, y in metres.
    pub(super) partitions: Vec<ShapeId>,
    pub(super) tables: ShapeId,
    walls: Vec<ShapeId>,
    blinds: Vec<Vec<ShapeId>>,
}

impl Kit {
    pub(super) fn new(builder: &mut Builder, seed: u64) -> Kit {
        let trunk = builder.shape(trunk());
        let crown = builder.shape(crown());
        let mut random = Random::stream(seed, 2, 0);
        Kit {
            ground: builder.shape(Shape::panel("ground", 8, 8, |_, _| false)),
            tree: builder.mesh_of(&[(crown, Paint::Leaf), (trunk, Paint::Bark)]),
            cuboid: builder.shape(Shape::unit_box("slab")),
            roof: builder.shape(roof()),
            partitions: (0..6).map(|_| builder.shape(partitions(&mut random))).collect(),
            tables: builder.shape(tables()),
            walls: (1..=MAX_FLOORS).map(|floors| builder.shape(wall(floors))).collect(),
            blinds: (1..=MAX_FLOORS)
                .map(|floors| (0..BLINDS).map(|_| builder.shape(blinds(floors, &mut random))).collect())
                .collect(),
        }
    }

    /// Outer wall of `floors` floors (1..=MAX_FLOORS): side 1 along x, metres along y from 0, facing +z.
    pub(super) fn wall(&self, floors: usize) -> ShapeId {
        self.walls[floors - 1]
    }

    /// One of the patterns of blinds that fit [`Kit::wall`].
    pub(super) fn blinds(&self, floors: usize, random: &mut Random) -> ShapeId {
        random.pick(&self.blinds[floors - 1])
    }
}

/// Calls `bay` with the left and right edge of the bay, those of its window, and the height of the floor.
fn each_bay(floors: usize, mut bay: impl FnMut([f64; 4], f64)) {
    for (floor, k) in (0..floors).flat_map(|floor| (0..BAYS).map(move |k| (floor, k))) {
        let edge = |k: usize| k as f64 / BAYS as f64 - 0.5;
        let within = |share: f64| edge(k) + share / BAYS as f64;
        bay([edge(k), edge(k + 1), within(WINDOW[0]), within(WINDOW[1])], floor as f64 * FLOOR);
    }
}

fn rectangle(shape: &mut Shape, [x0, x1]: [f64; 2], [y0, y1]: [f64; 2], z: f64) {
    shape.quad([[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]]);
}

fn wall(floors: usize) -> Shape {
    let mut shape = Shape::new(format!("wall of {floors} floors"));
    each_bay(floors, |[x0, x1, left, right], y| {
        rectangle(&mut shape, [x0, left], [y, y + FLOOR], 0.0);
        rectangle(&mut shape, [right, x1], [y, y + FLOOR], 0.0);
        rectangle(&mut shape, [left, right], [y, y + WINDOW[2]], 0.0);
        rectangle(&mut shape, [left, right], [y + WINDOW[3], y + FLOOR], 0.0);
    });
    shape
}

/// 55 % of the windows have a blind, 60 % of these fully closed, 5 cm behind the wall.
fn blinds(floors: usize, random: &mut Random) -> Shape {
    let mut shape = Shape::new(format!("blinds of {floors} floors"));
    each_bay(floors, |[_, _, left, right], y| {
        // The first window has one always: no shape is empty.
        if shape.indices.is_empty() || random.chance(0.55) {
            let drop = if random.chance(0.6) { 1.0 } else { random.range(0.2, 0.8) };
            let bottom = WINDOW[3] - drop * (WINDOW[3] - WINDOW[2]);
            rectangle(&mut shape, [left, right], [y + bottom, y + WINDOW[3]], -0.05);
        }
    });
    shape
}

/// Three walls across the footprint with a door each, from slab to slab.
fn partitions(random: &mut Random) -> Shape {
    const TOP: f64 = FLOOR - 0.2;
    const DOOR_TOP: f64 = 2.1;
    let mut shape = Shape::new("partitions");
    for k in 0..3 {
        let at = random.range(-0.35, 0.35);
        let door = random.range(-0.4, 0.3);
        let ends = if k == 0 { [-0.49, 0.49] } else { [-0.49, 0.0] };
        let mut sheet = |[a0, a1]: [f64; 2], [y0, y1]: [f64; 2]| {
            let corners = [(a0, y0), (a1, y0), (a1, y1), (a0, y1)];
            shape.quad(corners.map(|(a, y)| if k == 0 { [a, y, at] } else { [at, y, a] }));
        };
        let door = [door, door + 0.08].map(|x: f64| x.clamp(ends[0] + 0.02, ends[1] - 0.02));
        sheet([ends[0], door[0]], [0.0, TOP]);
        sheet([door[1], ends[1]], [0.0, TOP]);
        if door[1] > door[0] {
            sheet(door, [DOOR_TOP, TOP]);
        }
    }
    shape
}

/// Two tables of a top, two legs and a bar, with two chairs each of a seat, a back and a leg: 20 boxes.
fn tables() -> Shape {
    let mut shape = Shape::new("tables");
    let mut add = |[x, y, z]: [f64; 3], [sx, sy, sz]: [f64; 3]| {
        shape.cuboid([x - 0.5 * sx, y, z - 0.5 * sz], [x + 0.5 * sx, y + sy, z + 0.5 * sz]);
    };
    for x in [-1.2, 1.2] {
        add([x, 0.72, 0.0], [1.6, 0.04, 0.8]);
        for (dx, dz) in [(-0.75, -0.35), (0.75, 0.35)] {
            add([x + dx, 0.0, dz], [0.05, 0.72, 0.05]);
        }
        for side in [-1.0, 1.0] {
            let z = side * 0.75;
            add([x, 0.42, z], [0.45, 0.05, 0.45]);
            add([x, 0.47, z + side * 0.2], [0.45, 0.45, 0.04]);
            add([x - 0.18, 0.0, z], [0.05, 0.42, 0.4]);
        }
        add([x, 0.1, 0.0], [1.4, 0.05, 0.05]);
    }
    shape
}

/// Flat roof of side 1 with a parapet; y in metres from the roof's underside.
fn roof() -> Shape {
    let mut shape = Shape::new("roof");
    shape.cuboid([-0.5, 0.0, -0.5], [0.5, 0.25, 0.5]);
    for (min, max) in [([-0.5, -0.5], [0.5, -0.49]), ([-0.5, 0.49], [0.5, 0.5])] {
        shape.cuboid([min[0], 0.25, min[1]], [max[0], 0.85, max[1]]);
        shape.cuboid([min[1], 0.25, -0.49], [max[1], 0.85, 0.49]);
    }
    shape
}

/// Crown of a tree of height 1.
fn crown() -> Shape {
    let mut shape = Shape::sphere("tree", 14, 8);
    for p in &mut shape.positions {
        *p = [p[0], 0.62 + 0.75 * p[1], p[2]];
    }
    shape
}

/// Trunk of a tree of height 1.
fn trunk() -> Shape {
    let mut shape = Shape::new("trunk");
    shape.add_cylinder(8, 1, 0.05, 0.2);
    for p in &mut shape.positions {
        p[1] += 0.2;
    }
    shape
}
