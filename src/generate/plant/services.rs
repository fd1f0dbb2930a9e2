//! What stands and runs between the machines: pipes, crates, handrails.

use super::kit::{Kit, turn};
use super::{Plan, purpose};
use crate::generate::builder::{Builder, NodeId, Transform};
use crate::generate::paint::Paint;
use crate::generate::random::Random;

/// 2.2 runs of pipe per machine, from its top to a neighbour's: up, along x, along z, down.
pub(super) fn pipes(builder: &mut Builder, kit: &Kit, plan: Plan, tops: &[f64], seed: u64, root: NodeId) {
    const PAINTS: [Paint; 4] = [Paint::PipeGreen, Paint::PipeBlue, Paint::Steel, Paint::Copper];
    let piping = builder.group(Some(root), "piping", Transform::IDENTITY);
    for run in 0..(plan.machines * 22).div_ceil(10) {
        let mut random = Random::stream(seed, purpose::PIPES, run as u64);
        let from = run * 10 / 22;
        // A machine up to two columns and one row away; in a tiny plant it may be the same one.
        let to = (from + random.below(3) + plan.columns * random.below(2)).min(plan.machines - 1);
        let [start, end] = [from, to].map(|machine| {
            let [x, z] = plan.centre(machine);
            [x + random.range(-2.2, 2.2), tops[machine], z + random.range(-1.3, 1.3)]
        });
        let height = random.range(9.2, 12.5);
        let diameter = random.range(0.2, 0.5);
        let paint = random.pick(&PAINTS);
        let (pipe, elbow) = (builder.mesh(kit.pipe, paint), builder.mesh(kit.elbow, paint));
        let corners =
            [start, [start[0], height, start[2]], [end[0], height, start[2]], [end[0], height, end[2]], end];
        let group = builder.group(Some(piping), format!("run {}", run + 1), Transform::IDENTITY);
        for (k, pair) in corners.windows(2).enumerate() {
            let centre = [0, 1, 2].map(|axis| 0.5 * (pair[0][axis] + pair[1][axis]));
            let axis = [1, 0, 2, 1][k];
            let rotation = [turn::ALONG_X, turn::FRONT, turn::ALONG_Z][axis];
            let at = Transform::at(centre[0], centre[1], centre[2]).rotated(rotation);
            // Two pipes may come to lie one above the other; no pipe has a length of 0.
            let pipe_length = (pair[1][axis] - pair[0][axis]).abs().max(0.05);
            builder.object(
                group,
                format!("pipe {}", k + 1),
                pipe,
                at.scaled(diameter, pipe_length, diameter),
            );
            if k < 3 {
                let [x, y, z] = pair[1];
                let at = Transform::at(x, y, z).scaled(1.2 * diameter, 1.2 * diameter, 1.2 * diameter);
                builder.object(group, format!("elbow {}", k + 1), elbow, at);
            }
        }
    }
}

/// Two stacks of 1-5 crates per machine, in the aisle along x.
pub(super) fn storage(builder: &mut Builder, kit: &Kit, plan: Plan, seed: u64, root: NodeId) {
    let storage = builder.group(Some(root), "storage", Transform::IDENTITY);
    let mesh = builder.mesh(kit.crate_box, Paint::Timber);
    for stack in 0..2 * plan.machines {
        let mut random = Random::stream(seed, purpose::STORAGE, stack as u64);
        let [x, z] = plan.centre(stack / 2);
        let side = if stack % 2 == 0 { 1.0 } else { -1.0 };
        let at = Transform::at(x + random.range(-5.5, 5.5), 0.0, z + side * random.range(5.6, 6.4));
        let group = builder.group(Some(storage), format!("stack {}", stack + 1), at);
        let mut height = 0.0;
        for k in 0..1 + random.below(5) {
            let size = random.range(0.7, 1.2);
            let rotation = if random.chance(0.5) { turn::FRONT } else { turn::LOOSE[1] };
            let at =
                Transform::at(random.range(-0.1, 0.1), height, random.range(-0.1, 0.1)).rotated(rotation);
            builder.object(group, format!("crate {}", k + 1), mesh, at.scaled(size, size, size));
            height += size;
        }
    }
}

/// Three lengths of handrail on most machines' fronts.
pub(super) fn handrails(builder: &mut Builder, kit: &Kit, plan: Plan, seed: u64, root: NodeId) {
    let walkways = builder.group(Some(root), "walkways", Transform::IDENTITY);
    let mesh = builder.mesh(kit.handrail, Paint::SafetyYellow);
    for machine in 0..plan.machines {
        let mut random = Random::stream(seed, purpose::RAILS, machine as u64);
        let [x, z] = plan.centre(machine);
        let side = if random.chance(0.5) { 1.0 } else { -1.0 };
        let group = builder.group(
            Some(walkways),
            format!("walkway {}", machine + 1),
            Transform::at(x, 0.0, z + side * 4.0),
        );
        for k in 0..2 + random.below(2) {
            builder.object(
                group,
                format!("handrail {}", k + 1),
                mesh,
                Transform::at(2.0 * k as f64 - 2.0, 0.0, 0.0),
            );
        }
    }
}
