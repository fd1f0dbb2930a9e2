//! One machine: a housing on a plinth, with a row of sub-assemblies inside, each in a casing full of parts.

use super::kit::{Kit, turn};
use crate::generate::assembly::Assembly;
use crate::generate::builder::{Builder, Transform};
use crate::generate::paint::Paint;
use crate::generate::random::Random;

const HOUSINGS: [Paint; 4] = [Paint::Sage, Paint::SlateBlue, Paint::Sand, Paint::Graphite];
const PARTS: [Paint; 6] =
    [Paint::Steel, Paint::Steel, Paint::Iron, Paint::Brass, Paint::Copper, Paint::SignalRed];
/// Height of the concrete plinth, metres.
const PLINTH: f64 = 0.25;

/// A machine to be placed many times; its origin is on the floor below its centre.
#[derive(Debug)]
pub(super) struct Design {
    pub(super) assembly: Assembly,
    /// Height of the housing's top above the floor, metres.
    pub(super) top: f64,
}

/// Draws one machine of 5-9 x 5-8.5 x 3-5 m (x, y, z).
pub(super) fn design(builder: &mut Builder, kit: &Kit, random: &mut Random) -> Design {
    let size = [random.range(5.0, 9.0), random.range(5.0, 8.5), random.range(3.0, 5.0)];
    let [x, y, z] = size;
    let paint = random.pick(&HOUSINGS);
    let mut machine = Assembly::default();
    let plinth = builder.mesh(kit.cuboid, Paint::Concrete);
    let at = Transform::at(0.0, 0.5 * PLINTH, 0.0).scaled(x + 0.4, PLINTH, z + 0.4);
    machine.object("plinth", plinth, at);

    let housing = kit.housing(builder, &kit.large, size, true, paint, random);
    // One centimetre above the plinth: no two faces lie in one plane.
    let centre = PLINTH + 0.01 + 0.5 * y;
    machine.group("housing", Transform::at(0.0, centre, 0.0), housing);

    let count = 3 + random.below(3);
    let slot = (x - 0.4) / count as f64;
    for k in 0..count {
        let inner =
            [slot * random.range(0.75, 0.92), y * random.range(0.55, 0.85), z * random.range(0.6, 0.85)];
        let paint = random.pick(&HOUSINGS);
        let unit = sub_assembly(builder, kit, inner, k == 0, paint, random);
        let x = (k as f64 + 0.5) * slot - 0.5 * (x - 0.4);
        machine.group(format!("unit {}", k + 1), Transform::at(x, centre - 0.05 * y, 0.0), unit);
    }

    let mut fittings = Assembly::default();
    for k in 0..6 {
        let (name, shape) = random.pick(&kit.parts);
        let mesh = builder.mesh(shape, random.pick(&[Paint::SafetyYellow, Paint::Steel, Paint::SignalRed]));
        let side = if k % 2 == 0 { 1.0 } else { -1.0 };
        let at =
            Transform::at(random.range(-0.42, 0.42) * x, random.range(0.8, 2.6), side * (0.5 * z + 0.25));
        fittings.object(format!("{name} {}", k + 1), mesh, at.rotated(turn::ALONG_Z).scaled(0.4, 0.4, 0.4));
    }
    machine.group("fittings", Transform::IDENTITY, fittings);
    Design { assembly: machine, top: PLINTH + y }
}

/// A casing of the given size, centred on the origin, with 12-20 parts of 0.12-0.35 of its smallest side.
fn sub_assembly(
    builder: &mut Builder,
    kit: &Kit,
    size: [f64; 3],
    grille: bool,
    paint: Paint,
    random: &mut Random,
) -> Assembly {
    let mut unit = Assembly::default();
    unit.group("casing", Transform::IDENTITY, kit.housing(builder, &kit.small, size, grille, paint, random));
    let smallest = size[0].min(size[1]).min(size[2]);
    let mut parts = Assembly::default();
    for k in 0..12 + random.below(9) {
        let (name, shape) = random.pick(&kit.parts);
        let mesh = builder.mesh(shape, random.pick(&PARTS));
        let side = smallest * random.range(0.12, 0.35);
        // The part's box, however it is turned, stays inside the casing.
        let [x, y, z] = size.map(|s| random.range(-0.5, 0.5) * (s - 1.6 * side));
        let rotation = random.pick(&turn::LOOSE);
        parts.object(
            format!("{name} {}", k + 1),
            mesh,
            Transform::at(x, y, z).rotated(rotation).scaled(side, side, side),
        );
    }
    unit.group("parts", Transform::IDENTITY, parts);
    unit
}
