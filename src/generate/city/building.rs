//! One building: facade, floors, roof.

use super::kit::Kit;
use crate::generate::builder::{Builder, NodeId, Transform};
use crate::generate::paint::Paint;
use crate::generate::random::Random;
use std::f64::consts::FRAC_1_SQRT_2 as R;

/// Height of a floor, metres.
pub(super) const FLOOR: f64 = 3.0;
/// Windows per floor and wall.
pub(super) const BAYS: usize = 6;
/// Floors of the highest building.
pub(super) const MAX_FLOORS: usize = 12;

/// A building of 18-27 x 18-27 m with 2-12 floors in the middle of the lot.
pub(super) fn build(builder: &mut Builder, kit: &Kit, lot: NodeId, random: &mut Random) {
    let [x, z] = [(); 2].map(|()| (random.range(36.0, 54.0)).round() * 0.5);
    let floors = 2 + random.below(MAX_FLOORS - 1);
    let building = builder.group(Some(lot), "building", Transform::IDENTITY);
    facade(builder, kit, building, [x, z], floors, random);
    for floor in 0..floors {
        let at = Transform::at(0.0, floor as f64 * FLOOR, 0.0);
        let group = builder.group(Some(building), format!("floor {floor}"), at);
        interior(builder, kit, group, [x, z], random);
    }
    let top = floors as f64 * FLOOR;
    let roof = builder.group(Some(building), "roof", Transform::at(0.0, top, 0.0));
    let mesh = builder.mesh(kit.roof, Paint::RoofTar);
    builder.object(roof, "roof slab", mesh, Transform::IDENTITY.scaled(x, 1.0, z));
    let hut = builder.mesh(kit.cuboid, Paint::FacadeGrey);
    let at = Transform::at(random.range(-0.2, 0.2) * x, 1.5, random.range(-0.2, 0.2) * z);
    builder.object(roof, "stair head", hut, at.scaled(4.0, 2.5, 3.0));
}

fn facade(
    builder: &mut Builder,
    kit: &Kit,
    building: NodeId,
    [x, z]: [f64; 2],
    floors: usize,
    random: &mut Random,
) {
    let paint = random.pick(&[Paint::Facade, Paint::FacadeBrick, Paint::FacadeGrey]);
    let facade = builder.group(Some(building), "facade", Transform::IDENTITY);
    let sides = [
        ("south", [0.0, 0.0, 0.0, 1.0], [0.0, 0.5 * z], x),
        ("north", [0.0, 1.0, 0.0, 0.0], [0.0, -0.5 * z], x),
        ("east", [0.0, R, 0.0, R], [0.5 * x, 0.0], z),
        ("west", [0.0, -R, 0.0, R], [-0.5 * x, 0.0], z),
    ];
    for (name, rotation, [px, pz], width) in sides {
        let at = Transform::at(px, 0.0, pz).rotated(rotation).scaled(width, 1.0, 1.0);
        let wall = builder.mesh(kit.wall(floors), paint);
        builder.object(facade, format!("{name} wall"), wall, at);
        let blinds = builder.mesh(kit.blinds(floors, random), Paint::Blind);
        builder.object(facade, format!("{name} blinds"), blinds, at);
    }
}

/// Slab, partition walls and two groups of tables.
fn interior(builder: &mut Builder, kit: &Kit, floor: NodeId, [x, z]: [f64; 2], random: &mut Random) {
    let slab = builder.mesh(kit.cuboid, Paint::Concrete);
    // A hand's breadth short of the walls' blinds.
    builder.object(floor, "slab", slab, Transform::at(0.0, 0.1, 0.0).scaled(x - 0.2, 0.2, z - 0.2));
    let partitions = builder.mesh(random.pick(&kit.partitions), Paint::Plaster);
    builder.object(floor, "partitions", partitions, Transform::at(0.0, 0.2, 0.0).scaled(x, 1.0, z));
    let tables = builder.mesh(kit.tables, Paint::Timber);
    for k in 1..=2 {
        let at = Transform::at(random.range(-0.38, 0.38) * x, 0.2, random.range(-0.4, 0.4) * z);
        builder.object(floor, format!("tables {k}"), tables, at);
    }
}
