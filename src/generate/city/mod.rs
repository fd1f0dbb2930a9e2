//! Blocks of buildings with open windows, slabs, partition walls and furniture.

mod building;
mod kit;

use super::builder::{Builder, NodeId, Transform};
use super::paint::Paint;
use super::random::Random;
use super::{Sample, SampleOptions};
use kit::Kit;

/// Side of a square lot, metres.
const LOT: f64 = 40.0;
/// Lots along the side of a block.
const BLOCK: usize = 4;

/// 400 lots at scale 1, filled row by row into a square.
pub(super) fn city(options: &SampleOptions) -> Sample {
    let lots = options.count(400, 1);
    let columns = (lots as f64).sqrt().ceil() as usize;
    let mut builder = Builder::default();
    let mut kit = Kit::new(&mut builder, options.seed);
    let root = builder.group(None, "city", Transform::IDENTITY);
    let half = 0.5 * columns as f64 * LOT;
    let blocks = columns.div_ceil(BLOCK);
    for (row, column) in (0..blocks * blocks).map(|k| (k / blocks * BLOCK, k % blocks * BLOCK)) {
        let rows = row..(row + BLOCK).min(columns);
        let lots_here: Vec<usize> = rows
            .flat_map(|z| (column..(column + BLOCK).min(columns)).map(move |x| z * columns + x))
            .filter(|&lot| lot < lots)
            .collect();
        if lots_here.is_empty() {
            continue;
        }
        let name = format!("block {}.{}", row / BLOCK + 1, column / BLOCK + 1);
        let block = builder.group(Some(root), name, Transform::IDENTITY);
        for index in lots_here {
            let [x, z] = [index % columns, index / columns].map(|k| (k as f64 + 0.5) * LOT - half);
            let node = builder.group(Some(block), format!("lot {}", index + 1), Transform::at(x, 0.0, z));
            lot(&mut builder, &mut kit, node, &mut Random::stream(options.seed, 1, index as u64));
        }
    }
    builder.finish()
}

/// Ground, a tree and a building.
fn lot(builder: &mut Builder, kit: &mut Kit, lot: NodeId, random: &mut Random) {
    let ground = builder.mesh(kit.ground, Paint::Grass);
    builder.object(lot, "ground", ground, Transform::IDENTITY.rotated(kit::UP).scaled(LOT, LOT, 1.0));
    let size = random.range(4.0, 7.0);
    let corner = random.range(15.5, 17.0);
    builder.object(
        lot,
        "tree",
        kit.tree,
        Transform::at(corner, 0.0, -corner).scaled(0.8 * size, size, 0.8 * size),
    );
    building::build(builder, kit, lot, random);
}
