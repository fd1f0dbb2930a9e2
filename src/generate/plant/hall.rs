//! The building: floor, roof, walls, columns and beams.

use super::kit::{Kit, turn};
use super::{BAY, HEIGHT, Plan, purpose};
use crate::generate::builder::{Builder, MeshId, NodeId, Transform};
use crate::generate::paint::Paint;
use crate::generate::random::Random;

/// Half a bay: the grid of tiles, wall panels and beams, metres.
const HALF: f64 = 0.5 * BAY;

pub(super) fn build(builder: &mut Builder, kit: &Kit, plan: Plan, seed: u64, root: NodeId) {
    let hall = builder.group(Some(root), "hall", Transform::IDENTITY);
    let mut random = Random::stream(seed, purpose::HALL, 0);
    let floor = builder.mesh(kit.floor_tile, Paint::Concrete);
    let sheet = builder.mesh(kit.roof_tile, Paint::RoofSheet);
    let skylight = builder.mesh(kit.skylight, Paint::RoofSheet);
    tiles(builder, hall, plan, "floor", 0.0, || floor);
    tiles(builder, hall, plan, "roof", HEIGHT, || if random.chance(0.2) { skylight } else { sheet });
    walls(builder, kit, hall, plan, &mut random);
    frame(builder, kit, hall, plan);
}

/// Two tiles of 7.5 x 15 m per bay at height `y`, in one group per row of bays.
fn tiles(
    builder: &mut Builder,
    hall: NodeId,
    plan: Plan,
    name: &str,
    y: f64,
    mut mesh: impl FnMut() -> MeshId,
) {
    let layer = builder.group(Some(hall), name, Transform::IDENTITY);
    let [length, width] = plan.size();
    for row in 0..plan.rows {
        let z = (row as f64 + 0.5) * BAY - 0.5 * width;
        let strip = builder.group(Some(layer), format!("{name} {}", row + 1), Transform::at(0.0, y, z));
        for k in 0..2 * plan.columns {
            let x = (k as f64 + 0.5) * HALF - 0.5 * length;
            let at = Transform::at(x, 0.0, 0.0).rotated(turn::UP).scaled(HALF, BAY, 1.0);
            builder.object(strip, format!("tile {}", k + 1), mesh(), at);
        }
    }
}

/// Panels of 7.5 x 14 m; 60 % have windows with mullions.
fn walls(builder: &mut Builder, kit: &Kit, hall: NodeId, plan: Plan, random: &mut Random) {
    let [length, width] = plan.size();
    let plain = builder.mesh(kit.wall, Paint::WallSheet);
    let windows = builder.mesh(kit.window_wall, Paint::WallSheet);
    let bars = builder.mesh(kit.mullions, Paint::Graphite);
    let walls = builder.group(Some(hall), "walls", Transform::IDENTITY);
    let sides = [
        ("north wall", turn::BACK, [0.0, -0.5 * width], 2 * plan.columns),
        ("south wall", turn::FRONT, [0.0, 0.5 * width], 2 * plan.columns),
        ("west wall", turn::LEFT, [-0.5 * length, 0.0], 2 * plan.rows),
        ("east wall", turn::RIGHT, [0.5 * length, 0.0], 2 * plan.rows),
    ];
    for (name, rotation, [x, z], panels) in sides {
        let wall = builder.group(Some(walls), name, Transform::at(x, 0.5 * HEIGHT, z).rotated(rotation));
        for k in 0..panels {
            let at = Transform::at((k as f64 + 0.5 - 0.5 * panels as f64) * HALF, 0.0, 0.0)
                .scaled(HALF, HEIGHT, 1.0);
            let open = random.chance(0.6);
            builder.object(wall, format!("panel {}", k + 1), if open { windows } else { plain }, at);
            if open {
                builder.object(wall, format!("mullions {}", k + 1), bars, at);
            }
        }
    }
}

/// A beam across the hall every 7.5 m, and columns at the corners of every other bay.
fn frame(builder: &mut Builder, kit: &Kit, hall: NodeId, plan: Plan) {
    let [length, width] = plan.size();
    let frame = builder.group(Some(hall), "frame", Transform::IDENTITY);
    let profile = builder.mesh(kit.profile, Paint::PipeBlue);
    for k in 1..2 * plan.columns {
        let x = k as f64 * HALF - 0.5 * length;
        let at = Transform::at(x, HEIGHT - 0.4, 0.0).rotated(turn::ALONG_Z).scaled(0.3, width - 0.1, 0.6);
        builder.object(frame, format!("beam {k}"), profile, at);
    }
    for row in (0..=plan.rows).step_by(2) {
        for column in 0..=plan.columns {
            // Columns at the walls stand inside them.
            let inside = |k: usize, size: f64| {
                (k as f64 * BAY - 0.5 * size).clamp(0.25 - 0.5 * size, 0.5 * size - 0.25)
            };
            let height = HEIGHT - 0.75;
            let at = Transform::at(inside(column, length), 0.5 * height, inside(row, width))
                .scaled(0.4, height, 0.4);
            builder.object(frame, format!("column {row}.{column}"), profile, at);
        }
    }
}
