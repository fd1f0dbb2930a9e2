//! Seeded random numbers that are the same on every machine.

use glam::DVec3;

/// SplitMix64 (Steele, Lea, Flood: Fast Splittable Pseudorandom Number Generators, OOPSLA 2014).
#[derive(Clone, Debug)]
pub(crate) struct Random(u64);

impl Random {
    /// A stream of its own for each `(seed, stream, index)`: more cameras do not change the first ones.
    pub(crate) fn new(seed: u64, stream: u64, index: u64) -> Self {
        let mut random = Self(seed);
        for value in [stream, index] {
            random.0 = random.next() ^ value.wrapping_mul(0xD1B5_4A32_D192_ED03);
        }
        random
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in `low..high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / 9_007_199_254_740_992.0)
    }

    /// Uniform in the unit ball, by rejection: no sine, whose last bit differs between machines.
    pub(crate) fn in_ball(&mut self) -> DVec3 {
        loop {
            let p = DVec3::from_array(std::array::from_fn(|_| self.between(-1.0, 1.0)));
            if p.length_squared() <= 1.0 {
                return p;
            }
        }
    }

    /// Uniform on the unit sphere.
    pub(crate) fn on_sphere(&mut self) -> DVec3 {
        loop {
            let p = self.in_ball();
            if p.length_squared() > 1e-4 {
                return p.normalize();
            }
        }
    }

    /// Uniform horizontal unit vector (y = 0).
    pub(crate) fn horizontal(&mut self) -> DVec3 {
        loop {
            let p = DVec3::new(self.between(-1.0, 1.0), 0.0, self.between(-1.0, 1.0));
            if (1e-4..=1.0).contains(&p.length_squared()) {
                return p.normalize();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_differ_and_repeat() {
        let draw = |seed, stream, index| Random::new(seed, stream, index).between(0.0, 1.0);
        assert_eq!(draw(1, 2, 3), draw(1, 2, 3));
        let all = [draw(1, 2, 3), draw(1, 2, 4), draw(1, 3, 3), draw(2, 2, 3)];
        for (i, a) in all.iter().enumerate() {
            assert!(all[i + 1..].iter().all(|b| a != b));
        }
    }

    #[test]
    fn directions_are_unit_and_balanced() {
        let mut random = Random::new(5, 0, 0);
        let mut sum = DVec3::ZERO;
        for _ in 0..20_000 {
            let d = random.on_sphere();
            assert!((d.length() - 1.0).abs() < 1e-12);
            sum += d;
        }
        assert!(sum.length() / 20_000.0 < 0.02);
        assert_eq!(random.horizontal().y, 0.0);
    }
}
