//! Shapes with flat faces: boxes, sheets with openings, louvres, profiles.

use super::Shape;

impl Shape {
    /// Box of side 1 about the origin.
    pub(in crate::generate) fn unit_box(name: &str) -> Shape {
        let mut shape = Shape::new(name);
        shape.cuboid([-0.5; 3], [0.5; 3]);
        shape
    }

    /// Sheet of side 1 in the x-y plane about the origin, facing +z: `columns` x `rows` cells, those that
    /// `open` names (column from -x, row from -y) left out. Not all cells may be open.
    pub(in crate::generate) fn panel(
        name: &str,
        columns: u32,
        rows: u32,
        mut open: impl FnMut(u32, u32) -> bool,
    ) -> Shape {
        let mut shape = Shape::new(name);
        let stride = columns + 1;
        // Only corners of closed cells become vertices.
        let mut corners = vec![None; (stride * (rows + 1)) as usize];
        for row in 0..rows {
            for column in 0..columns {
                if open(column, row) {
                    continue;
                }
                let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)]
                    .map(|(x, y): (u32, u32)| (column + x, row + y))
                    .map(|(x, y)| {
                        *corners[(y * stride + x) as usize].get_or_insert_with(|| {
                            let along = |k: u32, n: u32| f64::from(k) / f64::from(n) - 0.5;
                            shape.vertex([along(x, columns), along(y, rows), 0.0], [0.0, 0.0, 1.0])
                        })
                    });
                shape.triangle(a, b, c);
                shape.triangle(a, c, d);
            }
        }
        shape
    }

    /// `slats` louvres that fill the middle half of a panel of side 1 in the x-y plane. Seen along z each
    /// covers half of its pitch; they lean 4 cm outwards (z is in metres, x and y scale with the panel).
    pub(in crate::generate) fn louvres(name: &str, slats: u32) -> Shape {
        let mut shape = Shape::new(name);
        for slat in 0..slats {
            let low = (f64::from(slat) + 0.25) / f64::from(slats) * 0.5 - 0.25;
            let high = low + 0.25 / f64::from(slats);
            shape.quad([[-0.25, low, 0.04], [0.25, low, 0.04], [0.25, high, 0.0], [-0.25, high, 0.0]]);
        }
        shape
    }

    /// Rolled I profile: length 1 along y about the origin, 1 x 1 across.
    pub(in crate::generate) fn profile(name: &str) -> Shape {
        // Half of the outline, web and flanges 0.16 thick; the other half is the same turned by 180 degrees.
        const HALF: [[f64; 2]; 6] =
            [[-0.5, -0.5], [0.5, -0.5], [0.5, -0.34], [0.08, -0.34], [0.08, 0.34], [0.5, 0.34]];
        let mut shape = Shape::new(name);
        let outline: Vec<[f64; 2]> = HALF.iter().copied().chain(HALF.iter().map(|[x, z]| [-x, -z])).collect();
        for k in 0..outline.len() {
            let [[x0, z0], [x1, z1]] = [outline[k], outline[(k + 1) % outline.len()]];
            shape.quad([[x0, 0.5, z0], [x1, 0.5, z1], [x1, -0.5, z1], [x0, -0.5, z0]]);
        }
        // An end is split so that no corner lies on the edge of another face.
        for y in [0.5, -0.5] {
            let mut end = |corners: &[[f64; 2]]| {
                let mut corners: Vec<[f64; 3]> = corners.iter().map(|[x, z]| [*x, y, *z]).collect();
                if y > 0.0 {
                    corners.reverse();
                }
                shape.face(&corners);
            };
            end(&[[-0.08, -0.34], [0.08, -0.34], [0.08, 0.34], [-0.08, 0.34]]);
            for s in [1.0, -1.0] {
                end(&[
                    [-0.5 * s, -0.5 * s],
                    [0.5 * s, -0.5 * s],
                    [0.08 * s, -0.34 * s],
                    [-0.08 * s, -0.34 * s],
                ]);
                end(&[[0.5 * s, -0.5 * s], [0.5 * s, -0.34 * s], [0.08 * s, -0.34 * s]]);
                end(&[[-0.5 * s, -0.5 * s], [-0.08 * s, -0.34 * s], [-0.5 * s, -0.34 * s]]);
            }
        }
        shape
    }

    /// Surface of the box `-half..=half` (metres), each face `cells` x `cells`; `hole` leaves out the middle
    /// `2 hole - 1` cells squared of the +x face (for odd `cells`).
    pub(in crate::generate) fn box_shell(name: &str, half: f64, cells: u32, hole: Option<u32>) -> Shape {
        let mut shape = Shape::new(name);
        let along = |k: u32| half * (2.0 * f64::from(k) / f64::from(cells) - 1.0);
        let middle = cells / 2;
        for axis in 0..3 {
            for side in [half, -half] {
                for (u, v) in (0..cells * cells).map(|k| (k % cells, k / cells)) {
                    let in_hole = |hole: u32| u.abs_diff(middle) < hole && v.abs_diff(middle) < hole;
                    if axis == 0 && side > 0.0 && hole.is_some_and(in_hole) {
                        continue;
                    }
                    let mut corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(du, dv)| {
                        let mut corner = [side; 3];
                        corner[(axis + 1) % 3] = along(u + du);
                        corner[(axis + 2) % 3] = along(v + dv);
                        corner
                    });
                    if side < 0.0 {
                        corners.reverse();
                    }
                    shape.quad(corners);
                }
            }
        }
        shape
    }
}
