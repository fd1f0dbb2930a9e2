//! A factory hall: machines in housings, pipes between them, crates and handrails.

mod hall;
mod kit;
mod machine;
mod services;

use super::builder::{Builder, Transform};
use super::random::Random;
use super::{Sample, SampleOptions};
use kit::Kit;

/// Side of the square of floor each machine stands on, metres.
const BAY: f64 = 15.0;
/// Height of the hall, metres.
const HEIGHT: f64 = 14.0;
/// Distinct machines; the others repeat them, as identical subtrees.
const DESIGNS: usize = 8;

/// Families of random numbers.
mod purpose {
    pub(super) const KIT: u64 = 1;
    pub(super) const DESIGN: u64 = 2;
    pub(super) const MACHINE: u64 = 3;
    pub(super) const HALL: u64 = 4;
    pub(super) const PIPES: u64 = 5;
    pub(super) const STORAGE: u64 = 6;
    pub(super) const RAILS: u64 = 7;
}

/// The floor plan: machine k stands in bay (k % columns, k / columns). The hall is centred on the origin.
#[derive(Clone, Copy, Debug)]
struct Plan {
    machines: usize,
    columns: usize,
    rows: usize,
}

impl Plan {
    /// A hall about twice as long (x) as wide (z).
    fn new(machines: usize) -> Self {
        let columns = ((2 * machines) as f64).sqrt().ceil() as usize;
        Plan { machines, columns, rows: machines.div_ceil(columns) }
    }

    /// Length of the hall along x and width along z, metres.
    fn size(&self) -> [f64; 2] {
        [self.columns as f64 * BAY, self.rows as f64 * BAY]
    }

    /// x and z of the centre of a machine's bay.
    fn centre(&self, machine: usize) -> [f64; 2] {
        let [length, width] = self.size();
        let along = |k: usize, size: f64| (k as f64 + 0.5) * BAY - 0.5 * size;
        [along(machine % self.columns, length), along(machine / self.columns, width)]
    }
}

/// 32 machines at scale 1.
pub(super) fn plant(options: &SampleOptions) -> Sample {
    let seed = options.seed;
    let plan = Plan::new(options.count(32, 1));
    let mut builder = Builder::default();
    let kit = Kit::new(&mut builder, &mut Random::stream(seed, purpose::KIT, 0));
    let designs: Vec<machine::Design> = (0..DESIGNS)
        .map(|k| machine::design(&mut builder, &kit, &mut Random::stream(seed, purpose::DESIGN, k as u64)))
        .collect();
    let chosen: Vec<usize> =
        (0..plan.machines).map(|k| Random::stream(seed, purpose::MACHINE, k as u64).below(DESIGNS)).collect();
    let tops: Vec<f64> = chosen.iter().map(|&design| designs[design].top).collect();

    let root = builder.group(None, "plant", Transform::IDENTITY);
    hall::build(&mut builder, &kit, plan, seed, root);
    for row in 0..plan.rows {
        let line = builder.group(Some(root), format!("line {}", row + 1), Transform::IDENTITY);
        let first = row * plan.columns;
        for machine in first..plan.machines.min(first + plan.columns) {
            let [x, z] = plan.centre(machine);
            // Every other machine is turned by 180 degrees, as on a real line.
            let turn = if machine % 2 == 0 { Transform::IDENTITY.rotation } else { [0.0, 1.0, 0.0, 0.0] };
            let at = Transform::at(x, 0.0, z).rotated(turn);
            let name = format!("machine {}", machine + 1);
            designs[chosen[machine]].assembly.place(&mut builder, Some(line), &name, at);
        }
    }
    services::pipes(&mut builder, &kit, plan, &tops, seed, root);
    services::storage(&mut builder, &kit, plan, seed, root);
    services::handrails(&mut builder, &kit, plan, seed, root);
    builder.finish()
}
