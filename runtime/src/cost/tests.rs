//! The model against frames of known cost.

use super::*;
use proptest::prelude::*;

/// splitmix64.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Standard normal, by the sum of twelve.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

/// Milliseconds: base, per million triangles, per thousand objects; noise (relative standard deviation).
#[derive(Clone, Copy)]
struct Machine {
    cost: [f64; 3],
    noise: f64,
    /// Share of frames that take three times as long.
    outliers: f64,
}

impl Machine {
    fn frame(&self, random: &mut Random, triangles: u64, draws: u64) -> f64 {
        let [a, b, c] = self.cost;
        let clean = a + b * triangles as f64 * 1e-6 + c * draws as f64 * 1e-3;
        let late = if random.unit() < self.outliers { 3.0 } else { 1.0 };
        clean * (1.0 + self.noise * random.normal()).max(0.1) * late
    }
}

/// A camera path: load swings between a tenth and the whole.
fn load(random: &mut Random, frame: usize) -> (u64, u64) {
    let swing = 0.55 + 0.45 * (frame as f64 * 0.13).sin();
    let objects = (swing * 4000.0 * (0.9 + 0.2 * random.unit())) as u64;
    ((swing * 2e6 * (0.7 + 0.6 * random.unit())) as u64, objects)
}

const FAST: [f64; 3] = [0.8, 1.5, 1.0];
const SLOW: [f64; 3] = [12.0, 90.0, 4.0];

#[test]
fn finds_the_cost_of_a_machine_and_its_own_error() {
    for cost in [FAST, SLOW, [0.0, 40.0, 0.0], [3.0, 0.0, 6.0]] {
        for (noise, outliers) in [(0.0, 0.0), (0.05, 0.0), (0.05, 0.05), (0.2, 0.0)] {
            let machine = Machine { cost, noise, outliers };
            let mut random = Random(7);
            let mut model = CostModel::new();
            for frame in 0..300 {
                let (triangles, draws) = load(&mut random, frame);
                model.record(triangles, draws, machine.frame(&mut random, triangles, draws));
            }
            // Against the clean cost, all along the path.
            let worst = (0..100)
                .map(|frame| {
                    let (triangles, draws) = load(&mut random, frame);
                    let clean = Machine { noise: 0.0, outliers: 0.0, ..machine };
                    let clean = clean.frame(&mut random, triangles, draws);
                    (model.predict(triangles, draws) - clean).abs() / clean
                })
                .fold(0.0, f64::max);
            println!(
                "{cost:?}, noise {noise}, outliers {outliers}: worst {worst:.4}, reported {:.4}",
                model.error()
            );
            assert!(worst < 0.03 + noise, "{worst}");
            // The median of |normal| is 0.6745 standard deviations: what even the true model would report.
            let true_error = 0.6745 * noise;
            assert!((model.error() - true_error).abs() < 0.01 + 0.35 * true_error, "{}", model.error());
        }
    }
}

#[test]
fn is_of_use_after_a_few_frames() {
    for cost in [FAST, SLOW] {
        let machine = Machine { cost, noise: 0.05, outliers: 0.0 };
        let mut random = Random(3);
        let mut model = CostModel::new();
        for frame in 0..5 {
            let (triangles, draws) = load(&mut random, frame);
            model.record(triangles, draws, machine.frame(&mut random, triangles, draws));
        }
        let (triangles, draws) = load(&mut random, 5);
        let clean = Machine { noise: 0.0, ..machine }.frame(&mut random, triangles, draws);
        let error = (model.predict(triangles, draws) - clean).abs() / clean;
        assert!(error < 0.15, "{error}");
    }
}

/// Frames that are all alike say nothing of what costs what: the model must fit them and stay sane elsewhere.
#[test]
fn equal_frames_do_not_spoil_it() {
    let machine = Machine { cost: SLOW, noise: 0.05, outliers: 0.0 };
    let mut random = Random(11);
    let mut model = CostModel::new();
    for _ in 0..2000 {
        model.record(1_000_000, 2000, machine.frame(&mut random, 1_000_000, 2000));
    }
    let here = model.predict(1_000_000, 2000);
    assert!((here - 110.0).abs() < 5.0, "{here}");
    let half = model.predict(500_000, 1000);
    assert!(half > here * 0.45 && half < here * 0.75, "{half} of {here}");
    // And it still learns.
    for frame in 0..60 {
        let (triangles, draws) = load(&mut random, frame);
        model.record(triangles, draws, machine.frame(&mut random, triangles, draws));
    }
    let (triangles, draws) = (300_000, 500);
    let clean = Machine { noise: 0.0, ..machine }.frame(&mut random, triangles, draws);
    assert!((model.predict(triangles, draws) - clean).abs() < 0.1 * clean);
}

/// The machine becomes four times as slow: a window moved to another screen, a laptop unplugged.
#[test]
fn follows_a_change() {
    let mut random = Random(5);
    let mut model = CostModel::new();
    for (factor, frames) in [(1.0, 200), (4.0, 100), (1.0, 100)] {
        let machine = Machine { cost: FAST.map(|c| c * factor), noise: 0.05, outliers: 0.0 };
        for frame in 0..frames {
            let (triangles, draws) = load(&mut random, frame);
            model.record(triangles, draws, machine.frame(&mut random, triangles, draws));
        }
        let clean = Machine { noise: 0.0, ..machine }.frame(&mut random, 1_000_000, 2000);
        let error = (model.predict(1_000_000, 2000) - clean).abs() / clean;
        println!("factor {factor}: error {error:.4}");
        assert!(error < 0.15, "{factor}: {error}");
    }
}

#[test]
fn before_the_first_frame_the_prior_speaks() {
    let model = CostModel::new();
    assert_eq!(model.predict(0, 0), 0.5);
    assert_eq!(model.predict(1_000_000, 1000), 12.5);
    assert_eq!((model.error(), model.frames()), (1.0, 0));
    assert_eq!(model.triangles_for(12.5, 1000), 1_000_000);
    assert_eq!(model.triangles_for(2.4, 1000), 0);
    assert_eq!(model.triangles_for(f64::NAN, 0), 0);
}

proptest! {
    #[test]
    fn never_negative_and_never_not_a_number(
        frames in prop::collection::vec((any::<u64>(), any::<u64>(), any::<f64>()), 0..40),
        more in prop::collection::vec((0..10_000_000_u64, 0..10_000_u64, 0.0..100.0_f64), 0..40),
        ms in any::<f64>(), triangles: u64, draws: u64,
    ) {
        let mut model = CostModel::new();
        for (triangles, draws, ms) in frames.into_iter().chain(more) {
            model.record(triangles, draws, ms);
            prop_assert!(model.coefficients.iter().all(|c| c.is_finite() && *c >= 0.0), "{:?}", model);
            prop_assert!(model.error() >= 0.0 && model.error().is_finite());
        }
        prop_assert!(model.predict(triangles, draws).is_finite());
        prop_assert!(model.predict(triangles, draws) >= model.predict(triangles / 2, draws / 2));
        let fitting = model.triangles_for(ms, draws);
        prop_assert!(fitting == 0 || model.predict(fitting, draws) <= ms);
    }
}
