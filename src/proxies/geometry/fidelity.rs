//! How much of what a proxy stands for is shown wrong: by area, so that one small part that is gone does not decide.

use super::likeness::{TriangleLook, looks};
use super::soup::Soup;
use super::tree::TriangleTree;
use glam::{DVec3, Vec3, Vec3A};
use rayon::prelude::*;

/// A difference in looks, of 0 to 1, from which on a place counts as shown all wrong. Something dropped shows what is behind
/// it, and that is seldom as different as black and white.
const ALL_WRONG: f32 = 0.25;

/// Pixels of a distance at which a place counts as half wrong, as [`svs_runtime`] has it.
const HALF_WRONG: f64 = 8.0;

/// Means over places that are spread by area.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fidelity {
    /// Mean distance, metres.
    pub mean: f64,
    /// Root mean square of the distances, metres.
    pub rms: f64,
    /// How much of it has other colours or faces elsewhere, 0 to 1.
    pub wrong: f64,
}

impl Fidelity {
    /// The worse of the two in each figure.
    pub(super) fn max(self, other: Self) -> Self {
        Self {
            mean: self.mean.max(other.mean),
            rms: self.rms.max(other.rms),
            wrong: self.wrong.max(other.wrong),
        }
    }
}

/// A place on an original surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// Relative to the proxy's origin, metres.
    pub(super) point: [f32; 3],
    pub(super) look: TriangleLook,
    /// What it is one place of, square metres.
    pub(super) area: f32,
}

/// Places that stand for those of several surfaces, at most `count`: each for about the same area.
pub(super) fn thinned(places: &[Place], count: usize) -> Vec<Place> {
    let total: f64 = places.iter().map(|place| f64::from(place.area)).sum();
    if places.len() <= count || total.is_nan() || total <= 0.0 {
        return places.to_vec();
    }
    let step = total / count as f64;
    let mut thinned = Vec::with_capacity(count);
    let mut sum = 0.0;
    for place in places {
        sum += f64::from(place.area);
        while sum > (thinned.len() as f64 + 0.5) * step && thinned.len() < count {
            thinned.push(Place { area: step as f32, ..*place });
        }
    }
    thinned
}

/// Moves places to another origin.
pub(super) fn moved(places: &[Place], by: DVec3) -> impl Iterator<Item = Place> + '_ {
    places.iter().map(move |place| Place {
        point: (Vec3::from_array(place.point).as_dvec3() + by).as_vec3().to_array(),
        ..*place
    })
}

/// A surface to compare places with.
pub(super) struct Target {
    tree: TriangleTree,
    looks: Vec<TriangleLook>,
}

/// What comparing showed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Comparison {
    pub(super) fidelity: Fidelity,
    /// Largest distance, metres.
    pub(super) max: f64,
    /// Share that is shown wrong where a pixel is as large as was asked for.
    pub(super) loss: f64,
}

impl Target {
    pub(super) fn new(soup: &Soup) -> Self {
        Self { tree: TriangleTree::new(&soup.surface().triangles()), looks: looks(soup) }
    }

    /// Nearest triangle of each place; empty if there is none.
    pub(super) fn nearest(&self, places: &[Place]) -> Vec<(f32, u32)> {
        let nearest: Option<Vec<(f32, u32)>> = places
            .par_iter()
            .with_min_len(64)
            .map_init(Vec::new, |stack, place| self.tree.nearest(Vec3A::from(place.point), stack))
            .collect();
        nearest.unwrap_or_default()
    }

    /// Compares; `None` if there is nothing to compare with. `pixel` in metres.
    pub(super) fn compare(&self, places: &[Place], pixel: f64) -> Option<Comparison> {
        let nearest = self.nearest(places);
        let mut sums = Comparison::default();
        let mut total = 0.0;
        for (place, &(distance, triangle)) in places.iter().zip(&nearest) {
            let (area, distance) = (f64::from(place.area), f64::from(distance));
            let difference = place.look.difference(&self.looks[triangle as usize]);
            let wrong = f64::from((difference / ALL_WRONG).min(1.0));
            let off = distance / (distance + HALF_WRONG * pixel).max(f64::MIN_POSITIVE);
            sums.fidelity.mean += area * distance;
            sums.fidelity.rms += area * distance * distance;
            sums.fidelity.wrong += area * wrong;
            sums.loss += area * (1.0 - (1.0 - off) * (1.0 - wrong));
            sums.max = sums.max.max(distance);
            total += area;
        }
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        let Fidelity { mean, rms, wrong } = sums.fidelity;
        sums.fidelity = Fidelity { mean: mean / total, rms: (rms / total).sqrt(), wrong: wrong / total };
        sums.loss /= total;
        Some(sums)
    }
}

#[cfg(test)]
mod tests {
    use super::super::class::{Class, PlainClass};
    use super::super::measure::{Reference, places};
    use super::*;
    use proptest::prelude::*;

    const WHITE: [u8; 4] = [255; 4];

    fn plain() -> Class {
        Class::Plain(PlainClass {
            blend: false,
            double_sided: false,
            unlit: false,
            metallic: 0,
            roughness: 20,
            emissive: [0; 3],
            brightness: 0,
            flat: true,
        })
    }

    /// Triangles of a colour each.
    fn soup(triangles: &[([[f32; 3]; 3], [u8; 4])], class: Class) -> Soup {
        let positions: Vec<[f32; 3]> = triangles.iter().flat_map(|(corners, _)| *corners).collect();
        let count = positions.len();
        Soup {
            colors: triangles.iter().flat_map(|(_, color)| [*color; 3]).collect(),
            normals: vec![[0.0; 3]; count],
            uvs: vec![[0.0; 2]; count],
            vertex_class: vec![0; count],
            indices: (0..count as u32).collect(),
            classes: vec![class],
            positions,
        }
    }

    /// A square metre at a height, facing up.
    fn square(z: f32, color: [u8; 4]) -> [([[f32; 3]; 3], [u8; 4]); 2] {
        let [a, b, c, d] = [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
        [([a, b, c], color), ([a, c, d], color)]
    }

    fn compared(original: &Soup, simplified: &Soup) -> (f64, Fidelity) {
        Reference::of_soup(original, 1000).compare(simplified, None)
    }

    #[track_caller]
    fn near(found: (f64, Fidelity), max: f64, mean: f64, rms: f64, wrong: f64) {
        let (found_max, Fidelity { mean: found_mean, rms: found_rms, wrong: found_wrong }) = found;
        for (found, expected) in
            [(found_max, max), (found_mean, mean), (found_rms, rms), (found_wrong, wrong)]
        {
            assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
        }
    }

    #[test]
    fn a_plane_that_is_moved_is_off_everywhere_by_as_much() {
        let original = soup(&square(0.0, WHITE), plain());
        near(compared(&original, &original), 0.0, 0.0, 0.0, 0.0);
        for d in [0.5, -0.25, 1e-3] {
            let moved = soup(&square(d, WHITE), plain());
            let d = f64::from(d.abs());
            near(compared(&original, &moved), d, d, d, 0.0);
        }
    }

    #[test]
    fn half_of_a_surface_that_is_gone_counts_by_half_of_the_area() {
        // Two sheets, one above the other; what stays is one of them.
        let both = soup(&[square(0.0, WHITE), square(0.5, WHITE)].concat(), plain());
        let one = soup(&square(0.0, WHITE), plain());
        near(compared(&both, &one), 0.5, 0.25, 0.5 / 2.0_f64.sqrt(), 0.0);
        // The other way about something is there that should not be.
        near(compared(&one, &both), 0.5, 0.25, 0.5 / 2.0_f64.sqrt(), 0.0);
        // All of it: the diagonal of its box, and all wrong.
        let nothing = soup(&[], plain());
        let diagonal = 2.25_f64.sqrt();
        near(compared(&both, &nothing), diagonal, diagonal, diagonal, 1.0);
        near(compared(&nothing, &nothing), 0.0, 0.0, 0.0, 0.0);
    }

    #[test]
    fn colours_count_as_the_eye_sees_them() {
        let original = soup(&square(0.0, WHITE), plain());
        let painted = |color| compared(&original, &soup(&square(0.0, color), plain()));
        // A quarter of black against white is all wrong; square roots of linear values.
        let part = (1.0 - (207.0_f64 / 255.0).sqrt()) / 0.25;
        near(painted([207, 207, 207, 255]), 0.0, 0.0, 0.0, part);
        near(painted([207, 255, 255, 255]), 0.0, 0.0, 0.0, part / 3.0);
        near(painted([0, 0, 0, 255]), 0.0, 0.0, 0.0, 1.0);
        near(painted([64, 64, 64, 255]), 0.0, 0.0, 0.0, 1.0);
        // What covers less shows less of its colour.
        near(painted([255, 255, 255, 230]), 0.0, 0.0, 0.0, (25.0 / 255.0) / 0.25);
        // One of its two triangles.
        let mut half = square(0.0, WHITE);
        half[1].1 = [0, 0, 0, 255];
        near(compared(&original, &soup(&half, plain())), 0.0, 0.0, 0.0, 0.5);
    }

    #[test]
    fn faces_turned_over_and_other_textures_are_all_wrong() {
        let original = soup(&square(0.0, WHITE), plain());
        let turned = square(0.0, WHITE).map(|([a, b, c], color)| ([a, c, b], color));
        near(compared(&original, &soup(&turned, plain())), 0.0, 0.0, 0.0, 1.0);
        let kept = |material| soup(&square(0.0, WHITE), Class::Kept { material, flat: true });
        near(compared(&kept(3), &kept(3)), 0.0, 0.0, 0.0, 0.0);
        near(compared(&kept(3), &kept(4)), 0.0, 0.0, 0.0, 1.0);
        near(compared(&original, &kept(3)), 0.0, 0.0, 0.0, 1.0);
    }

    #[test]
    fn the_loss_is_by_pixels_and_of_what_is_not_wrong() {
        let original = soup(&square(0.0, WHITE), plain());
        let places = places(&original, &looks(&original), 100);
        let loss = |z: f32, color, pixel| {
            Target::new(&soup(&square(z, color), plain())).compare(&places, pixel).expect("triangles").loss
        };
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-6, "{found}");
        // Off by 8 pixels is half wrong, by 24 three quarters.
        close(loss(1.0, WHITE, 0.125), 0.5);
        close(loss(1.0, WHITE, 1.0 / 24.0), 0.75);
        close(loss(0.0, WHITE, 1.0), 0.0);
        let part = (1.0 - (207.0_f64 / 255.0).sqrt()) / 0.25;
        close(loss(1.0, [207, 207, 207, 255], 0.125), 1.0 - 0.5 * (1.0 - part));
        // A pixel without size: off by anything is all wrong.
        close(loss(1.0, WHITE, 0.0), 1.0);
        let nothing = Target::new(&soup(&[], plain()));
        assert!(nothing.compare(&places, 1.0).is_none() && nothing.nearest(&places).is_empty());
        assert!(Target::new(&original).compare(&[], 1.0).is_none());
    }

    #[test]
    fn the_worse_of_each_figure_counts() {
        let a = Fidelity { mean: 1.0, rms: 5.0, wrong: 0.2 };
        let b = Fidelity { mean: 2.0, rms: 3.0, wrong: 0.1 };
        assert_eq!(a.max(b), Fidelity { mean: 2.0, rms: 5.0, wrong: 0.2 });
    }

    #[test]
    fn thinned_places_keep_the_area() {
        let place =
            |k: u32, area: f32| Place { point: [k as f32, 0.0, 0.0], look: TriangleLook::default(), area };
        // The first tenth has half of the area.
        let places: Vec<Place> = (0..1000).map(|k| place(k, if k < 100 { 9.0 } else { 1.0 })).collect();
        let thin = thinned(&places, 60);
        assert_eq!(thin.len(), 60);
        let area: f64 = thin.iter().map(|place| f64::from(place.area)).sum();
        assert!((area - 1800.0).abs() < 1e-3, "{area}");
        assert_eq!(thin.iter().filter(|place| place.point[0] < 100.0).count(), 30);
        assert_eq!(thinned(&places, 1000), places);
        // One large place stands for several.
        let few = [place(0, 1e6), place(1, 1.0), place(2, 1.0)];
        assert!(thinned(&few, 2).iter().all(|place| place.point[0] == 0.0));
        let none: Vec<Place> = (0..5).map(|k| place(k, 0.0)).collect();
        assert_eq!(thinned(&none, 2), none, "nothing to weigh them by");
    }

    #[test]
    fn moved_places_keep_everything_else() {
        let place = Place { point: [1.0, 2.0, 3.0], look: TriangleLook::default(), area: 2.0 };
        let moved: Vec<Place> = moved(&[place], DVec3::new(0.5, -2.0, 1e3)).collect();
        assert_eq!(moved, [Place { point: [1.5, 0.0, 1003.0], ..place }]);
    }

    fn triangles() -> impl Strategy<Value = Vec<([[f32; 3]; 3], [u8; 4])>> {
        // On a grid: moving by whole numbers rounds nothing.
        let coordinate = (-512..512_i32).prop_map(|c| c as f32 / 512.0);
        let corner = prop::array::uniform3(coordinate);
        prop::collection::vec((prop::array::uniform3(corner), any::<[u8; 4]>()), 1..12)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn scaling_and_moving_changes_nothing_but_lengths(
            original in triangles(),
            simplified in triangles(),
            exponent in -12..12_i32,
            by in prop::array::uniform3(-32..32_i32),
        ) {
            let scale = 2.0_f64.powi(exponent);
            let at = |p: [f32; 3]| [0, 1, 2].map(|k| (p[k] + by[k] as f32) * scale as f32);
            let placed = |triangles: &[([[f32; 3]; 3], [u8; 4])]| {
                let placed: Vec<_> = triangles.iter().map(|(corners, color)| (corners.map(at), *color)).collect();
                soup(&placed, plain())
            };
            let (max, plain_fidelity) = compared(&soup(&original, plain()), &soup(&simplified, plain()));
            let (placed_max, moved) = compared(&placed(&original), &placed(&simplified));
            let Fidelity { mean, rms, wrong } = plain_fidelity;
            prop_assert!([max, mean, rms, wrong].iter().all(|figure| figure.is_finite() && *figure >= 0.0));
            prop_assert!(mean <= rms * (1.0 + 1e-9) && rms <= max * (1.0 + 1e-9) && wrong <= 1.0);
            // Places of the moved surface are rounded: to 2e-6, of lengths of about 1.
            for (found, expected) in [(placed_max, max), (moved.mean, mean), (moved.rms, rms)] {
                prop_assert!((found / scale - expected).abs() < 1e-4, "{} {expected}", found / scale);
            }
            // A place that is about as near to two triangles may take the other one's look.
            prop_assert!((moved.wrong - wrong).abs() < 0.02, "{} {wrong}", moved.wrong);
        }
    }
}
