//! Shapes of revolution and gears, with smooth normals where the real thing is smooth.

use super::Shape;
use crate::generate::portable::circle;

impl Shape {
    /// Closed cylinder about the y axis, diameter 1, height 1, centred on the origin: `around` facets, `along`
    /// rings of quads.
    pub(in crate::generate) fn cylinder(name: &str, around: u32, along: u32) -> Shape {
        let mut shape = Shape::new(name);
        shape.add_cylinder(around, along, 0.5, 0.5);
        shape
    }

    /// Adds a closed cylinder about the y axis, from `-half` to `half`.
    pub(in crate::generate) fn add_cylinder(&mut self, around: u32, along: u32, radius: f64, half: f64) {
        let rim = |k: u32, y: f64| {
            let [cos, sin] = circle(k % around, around);
            ([radius * cos, y, radius * sin], [cos, 0.0, sin])
        };
        let height = |ring: u32| half * (2.0 * f64::from(ring) / f64::from(along) - 1.0);
        let first = self.positions.len() as u16;
        for ring in 0..=along {
            for k in 0..around {
                let (position, normal) = rim(k, height(ring));
                self.vertex(position, normal);
            }
        }
        let at = |ring: u32, k: u32| first + (ring * around + k % around) as u16;
        for (ring, k) in pairs(along, around) {
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)];
            self.triangle(a, d, c);
            self.triangle(a, c, b);
        }
        for (y, up) in [(half, true), (-half, false)] {
            let rim: Vec<[f64; 3]> = (0..around).map(|k| rim(k, y).0).collect();
            self.disc([0.0, y, 0.0], &rim, up);
        }
    }

    /// Adds a flat fan about `centre` in a plane of constant y; `rim` runs from +x towards +z.
    fn disc(&mut self, centre: [f64; 3], rim: &[[f64; 3]], up: bool) {
        let normal = [0.0, if up { 1.0 } else { -1.0 }, 0.0];
        let middle = self.vertex(centre, normal);
        let rim: Vec<u16> = rim.iter().map(|&position| self.vertex(position, normal)).collect();
        for k in 0..rim.len() {
            let (a, b) = (rim[k], rim[(k + 1) % rim.len()]);
            if up { self.triangle(middle, b, a) } else { self.triangle(middle, a, b) }
        }
    }

    /// Sphere of diameter 1 about the origin, poles on y: `around` meridians, `down` bands from pole to pole.
    pub(in crate::generate) fn sphere(name: &str, around: u32, down: u32) -> Shape {
        let mut shape = Shape::new(name);
        let mut add = |normal: [f64; 3]| shape.vertex(normal.map(|x| 0.5 * x), normal);
        let north = add([0.0, 1.0, 0.0]);
        for band in 1..down {
            let [y, ring] = circle(band, 2 * down);
            for k in 0..around {
                let [cos, sin] = circle(k, around);
                add([ring * cos, y, ring * sin]);
            }
        }
        let south = add([0.0, -1.0, 0.0]);
        let at = |band: u32, k: u32| 1 + ((band - 1) * around + k % around) as u16;
        for k in 0..around {
            shape.triangle(north, at(1, k + 1), at(1, k));
            shape.triangle(south, at(down - 1, k), at(down - 1, k + 1));
        }
        for (band, k) in pairs(down - 2, around) {
            let band = band + 1;
            let [a, b, c, d] = [at(band, k), at(band, k + 1), at(band + 1, k + 1), at(band + 1, k)];
            shape.triangle(a, b, c);
            shape.triangle(a, c, d);
        }
        shape
    }

    /// Torus about the y axis, outer diameter 1; `tube` is the tube's radius (less than 0.25).
    pub(in crate::generate) fn torus(name: &str, around: u32, across: u32, tube: f64) -> Shape {
        let mut shape = Shape::new(name);
        for (k, j) in pairs(around, across) {
            let ([cos, sin], [out, up]) = (circle(k, around), circle(j, across));
            let radius = 0.5 - tube + tube * out;
            shape.vertex([radius * cos, tube * up, radius * sin], [out * cos, up, out * sin]);
        }
        let at = |k: u32, j: u32| ((k % around) * across + j % across) as u16;
        for (k, j) in pairs(around, across) {
            let [a, b, c, d] = [at(k, j), at(k, j + 1), at(k + 1, j + 1), at(k + 1, j)];
            shape.triangle(a, b, c);
            shape.triangle(a, c, d);
        }
        shape
    }

    /// Gear about the y axis, diameter 1, 0.2 thick, with `teeth` teeth, on a shaft of length 0.7.
    pub(in crate::generate) fn gear(name: &str, teeth: u32) -> Shape {
        let mut shape = Shape::new(name);
        // Four corners per tooth: root, root, tip, tip.
        let outline: Vec<[f64; 2]> = (0..4 * teeth)
            .map(|k| {
                let radius = if k % 4 < 2 { 0.42 } else { 0.5 };
                circle(k, 4 * teeth).map(|x| radius * x)
            })
            .collect();
        for k in 0..outline.len() {
            let [[x0, z0], [x1, z1]] = [outline[k], outline[(k + 1) % outline.len()]];
            shape.quad([[x0, 0.1, z0], [x1, 0.1, z1], [x1, -0.1, z1], [x0, -0.1, z0]]);
        }
        for (y, up) in [(0.1, true), (-0.1, false)] {
            let rim: Vec<[f64; 3]> = outline.iter().map(|[x, z]| [*x, y, *z]).collect();
            shape.disc([0.0, y, 0.0], &rim, up);
        }
        shape.add_cylinder(20, 2, 0.12, 0.35);
        shape
    }
}

/// All `(i, j)` with `i < rows`, `j < columns`, rows first.
fn pairs(rows: u32, columns: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..rows).flat_map(move |i| (0..columns).map(move |j| (i, j)))
}
