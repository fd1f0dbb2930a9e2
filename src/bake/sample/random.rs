//! Repeatable random numbers from arithmetic alone, so that every machine bakes the same bytes.

use glam::{DMat3, DQuat, DVec3};

/// SplitMix64 (Steele, Lea, Flood 2014): a counter through a mixing function.
#[derive(Clone, Debug)]
pub(crate) struct Random(u64);

impl Random {
    /// A stream for a seed and a place (batch, direction, …); different places give unrelated streams.
    pub(crate) fn new(seed: u64, place: u64) -> Self {
        Self(mix(seed ^ mix(place.wrapping_add(0x9E37_79B9_7F4A_7C15))))
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        mix(self.0)
    }

    /// Uniform in [0, 1), 53 bits.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Two uniform numbers in [0, 1), 32 bits each, from one step.
    pub(crate) fn pair(&mut self) -> (f64, f64) {
        let bits = self.next();
        ((bits >> 32) as f64 / 4_294_967_296.0, (bits & 0xFFFF_FFFF) as f64 / 4_294_967_296.0)
    }

    /// Uniform rotation: a random unit quaternion by rejection from the ball, which needs no trigonometry.
    pub(crate) fn rotation(&mut self) -> DMat3 {
        loop {
            let q = [0; 4].map(|_| self.unit() * 2.0 - 1.0);
            let squared: f64 = q.iter().map(|x| x * x).sum();
            if (1e-6..=1.0).contains(&squared) {
                let inverse = 1.0 / squared.sqrt();
                let [x, y, z, w] = q.map(|v| v * inverse);
                return DMat3::from_quat(DQuat::from_xyzw(x, y, z, w));
            }
        }
    }
}

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// `count` directions spread evenly over half a sphere (golden spiral), turned at random: one per line, since a
/// line is seen from both of its ends.
pub(crate) fn half_sphere(count: usize, random: &mut Random) -> Vec<DVec3> {
    // Cosine and sine of the golden angle, pi (3 - sqrt 5): a turn per step by complex multiplication.
    const COS: f64 = -0.737_368_878_078_319_7;
    const SIN: f64 = 0.675_490_294_261_523_6;
    let rotation = random.rotation();
    let (mut x, mut y) = (1.0f64, 0.0f64);
    (0..count)
        .map(|i| {
            let z = 1.0 - (i as f64 + 0.5) / count as f64;
            let ring = (1.0 - z * z).max(0.0).sqrt();
            let direction = rotation * DVec3::new(ring * x, ring * y, z);
            (x, y) = (x * COS - y * SIN, x * SIN + y * COS);
            let length = (x * x + y * y).sqrt();
            (x, y) = (x / length, y / length);
            direction / direction.length()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_constants_are_the_golden_angle() {
        let angle = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let directions = half_sphere(3, &mut Random::new(1, 2));
        assert!(directions.iter().all(|d| (d.length() - 1.0).abs() < 1e-14));
        let (sin, cos) = angle.sin_cos();
        assert!((cos - -0.737_368_878_078_319_7).abs() < 1e-15);
        assert!((sin - 0.675_490_294_261_523_6).abs() < 1e-15);
    }

    #[test]
    fn half_spheres_are_spread_evenly() {
        let directions = half_sphere(2_000, &mut Random::new(7, 0));
        // Both signs of every line: the mean outer product of an even set is a third of the identity.
        let moment: f64 = directions.iter().map(|d| d.x * d.x).sum::<f64>() / 2_000.0;
        assert!((moment - 1.0 / 3.0).abs() < 1e-3, "{moment}");
    }

    #[test]
    fn numbers_are_repeatable_and_in_range() {
        let mut random = Random::new(42, 1);
        assert_eq!(random.clone().next(), random.next());
        for _ in 0..1_000 {
            let (a, b) = random.pair();
            assert!((0.0..1.0).contains(&a) && (0.0..1.0).contains(&b) && (0.0..1.0).contains(&random.unit()));
        }
    }
}
