//! The shapes a plant is made of: each is written once and placed many times.

use crate::generate::assembly::Assembly;
use crate::generate::builder::{Builder, ShapeId, Transform};
use crate::generate::paint::Paint;
use crate::generate::random::Random;
use crate::generate::shape::Shape;
use std::f64::consts::FRAC_1_SQRT_2;

/// Unit quaternions that turn a sheet facing +z, or a pipe along y.
pub(super) mod turn {
    use super::FRAC_1_SQRT_2 as R;

    pub(in crate::generate) const FRONT: [f64; 4] = [0.0, 0.0, 0.0, 1.0];
    pub(in crate::generate) const BACK: [f64; 4] = [0.0, 1.0, 0.0, 0.0];
    pub(in crate::generate) const RIGHT: [f64; 4] = [0.0, R, 0.0, R];
    pub(in crate::generate) const LEFT: [f64; 4] = [0.0, -R, 0.0, R];
    pub(in crate::generate) const UP: [f64; 4] = [-R, 0.0, 0.0, R];
    pub(in crate::generate) const DOWN: [f64; 4] = [R, 0.0, 0.0, R];
    /// y to x.
    pub(in crate::generate) const ALONG_X: [f64; 4] = [0.0, 0.0, -R, R];
    /// y to z.
    pub(in crate::generate) const ALONG_Z: [f64; 4] = [R, 0.0, 0.0, R];
    /// Turns about y, x and z whose quaternions are exact in few decimals (3-4-5 and 7-24-25
    /// triangles): the text stays short and the length exactly 1.
    pub(in crate::generate) const LOOSE: [[f64; 4]; 8] = [
        [0.0, 0.6, 0.0, 0.8],
        [0.0, 0.28, 0.0, 0.96],
        [0.0, -0.28, 0.0, 0.96],
        [0.0, 0.96, 0.0, 0.28],
        [0.28, 0.0, 0.0, 0.96],
        [0.6, 0.0, 0.0, 0.8],
        [0.0, 0.0, 0.28, 0.96],
        [0.0, 0.0, 0.6, 0.8],
    ];
}

/// Sheets of one cell size, side 1.
#[derive(Debug)]
pub(super) struct Sheets {
    /// Without openings.
    pub(super) closed: ShapeId,
    /// With a few open cells.
    pub(super) worn: Vec<ShapeId>,
    /// With the middle half open, for a grille.
    pub(super) framed: ShapeId,
}

/// All shapes of a plant.
#[derive(Debug)]
pub(super) struct Kit {
    pub(super) large: Sheets,
    pub(super) small: Sheets,
    pub(super) louvres: ShapeId,
    pub(super) parts: Vec<(&'static str, ShapeId)>,
    pub(super) cuboid: ShapeId,
    pub(super) profile: ShapeId,
    pub(super) pipe: ShapeId,
    pub(super) elbow: ShapeId,
    pub(super) handrail: ShapeId,
    pub(super) crate_box: ShapeId,
    pub(super) floor_tile: ShapeId,
    pub(super) roof_tile: ShapeId,
    pub(super) skylight: ShapeId,
    pub(super) wall: ShapeId,
    pub(super) window_wall: ShapeId,
    pub(super) mullions: ShapeId,
}

impl Kit {
    pub(super) fn new(builder: &mut Builder, random: &mut Random) -> Kit {
        let parts = vec![
            ("drum", builder.shape(Shape::cylinder("drum", 40, 10))),
            ("roller", builder.shape(Shape::cylinder("roller", 28, 8))),
            ("vessel", builder.shape(Shape::sphere("vessel", 36, 18))),
            ("float", builder.shape(Shape::sphere("float", 28, 14))),
            ("ring", builder.shape(Shape::torus("ring", 40, 20, 0.11))),
            ("seal", builder.shape(Shape::torus("seal", 32, 16, 0.06))),
            ("wheel", builder.shape(Shape::gear("wheel", 36))),
            ("pinion", builder.shape(Shape::gear("pinion", 18))),
        ];
        Kit {
            large: sheets(builder, random, "housing sheet", 12, 0.05),
            small: sheets(builder, random, "casing sheet", 8, 0.06),
            louvres: builder.shape(Shape::louvres("louvres", 24)),
            parts,
            cuboid: builder.shape(Shape::unit_box("block")),
            profile: builder.shape(Shape::profile("I profile")),
            pipe: builder.shape(Shape::cylinder("pipe", 24, 8)),
            elbow: builder.shape(Shape::sphere("elbow", 20, 12)),
            handrail: builder.shape(handrail()),
            crate_box: builder.shape(crate_box()),
            floor_tile: builder.shape(Shape::panel("floor tile", 6, 6, |_, _| false)),
            roof_tile: builder.shape(Shape::panel("roof sheet", 8, 8, |_, _| false)),
            skylight: builder.shape(Shape::panel("roof sheet with skylight", 8, 8, |x, y| {
                (3..5).contains(&x) && (3..5).contains(&y)
            })),
            wall: builder.shape(Shape::panel("wall", 10, 14, |_, _| false)),
            window_wall: builder
                .shape(Shape::panel("wall with windows", 10, 14, |x, y| x % 3 != 0 && (6..9).contains(&y))),
            mullions: builder.shape(mullions()),
        }
    }

    /// Six sheets about the box of the given size, centred on the origin, and louvres on the +z side if `grille`.
    pub(super) fn housing(
        &self,
        builder: &mut Builder,
        sheets: &Sheets,
        size: [f64; 3],
        grille: bool,
        paint: Paint,
        random: &mut Random,
    ) -> Assembly {
        // Sheets reach a little over the edge they meet at, so that rounding opens no gap between them.
        const LIP: f64 = 0.02;
        let [x, y, z] = size.map(|side| side + LIP);
        let [right, top, front] = size.map(|side| 0.5 * side);
        let mut housing = Assembly::default();
        let faces = [
            ("front", turn::FRONT, [0.0, 0.0, front], [x, y]),
            ("back", turn::BACK, [0.0, 0.0, -front], [x, y]),
            ("right", turn::RIGHT, [right, 0.0, 0.0], [z, y]),
            ("left", turn::LEFT, [-right, 0.0, 0.0], [z, y]),
            ("top", turn::UP, [0.0, top, 0.0], [x, z]),
            ("bottom", turn::DOWN, [0.0, -top, 0.0], [x, z]),
        ];
        for (name, rotation, [px, py, pz], [width, height]) in faces {
            let shape = match name {
                "front" if grille => sheets.framed,
                "bottom" => sheets.closed,
                _ => random.pick(&sheets.worn),
            };
            let mesh = builder.mesh(shape, paint);
            housing.object(
                name,
                mesh,
                Transform::at(px, py, pz).rotated(rotation).scaled(width, height, 1.0),
            );
        }
        if grille {
            let mesh = builder.mesh(self.louvres, Paint::Louvre);
            housing.object("grille", mesh, Transform::at(0.0, 0.0, front).scaled(x, y, 1.0));
        }
        housing
    }
}

fn sheets(builder: &mut Builder, random: &mut Random, name: &str, cells: u32, worn: f64) -> Sheets {
    let middle = cells / 4..cells - cells / 4;
    Sheets {
        closed: builder.shape(Shape::panel(name, cells, cells, |_, _| false)),
        worn: (0..6)
            .map(|_| builder.shape(Shape::panel(name, cells, cells, |_, _| random.chance(worn))))
            .collect(),
        framed: builder
            .shape(Shape::panel(name, cells, cells, |x, y| middle.contains(&x) && middle.contains(&y))),
    }
}

/// Four window bars over the whole width of a wall panel (side 1, window rows 6 to 8 of 14).
fn mullions() -> Shape {
    let mut shape = Shape::new("mullions");
    for k in 0..4 {
        let x = 0.2 * f64::from(k) - 0.3;
        shape.cuboid([x - 0.008, 6.0 / 14.0 - 0.5, -0.06], [x + 0.008, 9.0 / 14.0 - 0.5, 0.06]);
    }
    shape
}

/// Two metres of handrail: three posts and two bars.
fn handrail() -> Shape {
    let mut shape = Shape::new("handrail");
    for x in [-0.98, 0.0, 0.98] {
        shape.cuboid([x - 0.02, 0.0, -0.02], [x + 0.02, 1.1, 0.02]);
    }
    for y in [0.55, 1.1] {
        shape.cuboid([-1.0, y - 0.02, -0.02], [1.0, y + 0.02, 0.02]);
    }
    shape
}

/// Transport crate of side 1 on the floor: a box with four corner posts and three battens below.
fn crate_box() -> Shape {
    let mut shape = Shape::new("crate");
    shape.cuboid([-0.46, 0.12, -0.46], [0.46, 0.98, 0.46]);
    for (x, z) in [(-0.46, -0.46), (0.46, -0.46), (0.46, 0.46), (-0.46, 0.46)] {
        shape.cuboid([x - 0.04, 0.0, z - 0.04], [x + 0.04, 1.0, z + 0.04]);
    }
    for z in [-0.3, 0.0, 0.3] {
        shape.cuboid([-0.5, 0.02, z - 0.06], [0.5, 0.12, z + 0.06]);
    }
    shape
}
