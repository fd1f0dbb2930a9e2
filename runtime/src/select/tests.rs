//! The selection against the best possible one, found by branch and bound.

use super::*;
use crate::cost::CostModel;
use proptest::prelude::*;

type Object = (f64, u32);

/// Which of `objects` are chosen.
fn chosen(objects: &[Object], capacity: &Capacity<'_>, published: bool) -> Vec<bool> {
    let mut selector = Selector::default();
    objects.iter().for_each(|&(value, triangles)| selector.push(value, triangles, false, capacity));
    if published {
        selector.choose_until_misfit(capacity);
    } else {
        selector.choose(capacity);
    }
    (0..objects.len()).map(|index| selector.is_chosen(index)).collect()
}

/// Value and triangles of a choice.
fn sum(objects: &[Object], chosen: &[bool]) -> (f64, u64) {
    let taken = objects.iter().zip(chosen).filter(|(_, chosen)| **chosen);
    taken.fold((0.0, 0), |sum, (o, _)| (sum.0 + o.0, sum.1 + u64::from(o.1)))
}

/// Value of the best set of at most `capacity` triangles: every set is tried, but for those that the relaxed problem, in
/// which objects can be cut, shows to be no better than the best so far.
fn optimum(objects: &[Object], capacity: u64) -> f64 {
    let mut sorted = objects.to_vec();
    let worth = |o: &Object| if o.1 == 0 { f64::INFINITY } else { o.0 / f64::from(o.1) };
    sorted.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    fn relaxed(objects: &[Object], mut left: u64) -> f64 {
        let mut value = 0.0;
        for &(v, w) in objects {
            if u64::from(w) > left {
                return value + v * left as f64 / f64::from(w);
            }
            (value, left) = (value + v, left - u64::from(w));
        }
        value
    }
    fn search(objects: &[Object], left: u64, value: f64, best: &mut f64) {
        *best = best.max(value);
        let Some((&(v, w), rest)) = objects.split_first() else { return };
        if value + relaxed(objects, left) <= *best * (1.0 + 1e-12) {
            return;
        }
        if u64::from(w) <= left {
            search(rest, left - u64::from(w), value + v, best);
        }
        search(rest, left, value, best);
    }
    let mut best = 0.0;
    search(&sorted, capacity, 0.0, &mut best);
    best
}

/// The same by trying all sets, literally.
fn exhaustive(objects: &[Object], capacity: u64) -> f64 {
    (0_u32..1 << objects.len())
        .map(|set| sum(objects, &(0..objects.len()).map(|k| set >> k & 1 == 1).collect::<Vec<_>>()))
        .filter(|&(_, triangles)| triangles <= capacity)
        .fold(0.0, |best, (value, _)| best.max(value))
}

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

    /// Even in the logarithm, as pixels and triangle counts are in real scenes.
    fn even_octaves(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }

    fn scene(&mut self, count: usize) -> (Vec<Object>, u64) {
        let objects: Vec<Object> =
            (0..count).map(|_| (self.even_octaves(0.01, 1e5), self.even_octaves(2.0, 2e5) as u32)).collect();
        let all: u64 = objects.iter().map(|o| u64::from(o.1)).sum();
        let share = self.even_octaves(0.02, 0.9);
        (objects, (all as f64 * share) as u64)
    }
}

fn objects() -> impl Strategy<Value = Vec<Object>> {
    let value = prop_oneof![4 => 0.0..1e6_f64, 1 => Just(0.0), 1 => Just(1e9)];
    let triangles = prop_oneof![6 => 0..2000_u32, 1 => Just(0), 1 => Just(u32::MAX), 1 => 0..10_u32];
    prop::collection::vec((value, triangles), 0..14)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn at_least_half_of_the_best_and_never_above_the_budget(
        objects in objects(), capacity in prop_oneof![0..8000_u64, any::<u64>()],
    ) {
        let best = optimum(&objects, capacity);
        prop_assert!((best - exhaustive(&objects, capacity)).abs() <= best * 1e-9);
        let (value, triangles) = sum(&objects, &chosen(&objects, &Capacity::Triangles(capacity), false));
        prop_assert!(triangles <= capacity);
        prop_assert!(value >= best * 0.5 * (1.0 - 1e-6) && value <= best * (1.0 + 1e-9), "{} {}", value, best);
        let (published, triangles) = sum(&objects, &chosen(&objects, &Capacity::Triangles(capacity), true));
        prop_assert!(triangles <= capacity);
        prop_assert!(published <= value * (1.0 + 1e-6));
    }

    /// Nothing that was left out would still fit, in triangles as in milliseconds.
    #[test]
    fn the_budget_is_used_up(objects in objects(), capacity in 0..8000_u64, ms in 0.0..20.0_f64) {
        let model = CostModel::new();
        for capacity in [Capacity::Triangles(capacity), Capacity::Milliseconds(ms, &model)] {
            let chosen = chosen(&objects, &capacity, false);
            let draws = chosen.iter().filter(|c| **c).count() as u64;
            let load = Load { triangles: sum(&objects, &chosen).1, draws };
            prop_assert!(capacity.fits(load) || draws == 0);
            for (object, _) in objects.iter().zip(&chosen).filter(|(_, chosen)| !**chosen) {
                prop_assert!(!capacity.fits(load.plus(object.1)));
            }
        }
    }

    #[test]
    fn the_order_of_the_candidates_does_not_matter(
        mut objects in objects(), capacity in 0..8000_u64, turn in 0..14_usize,
    ) {
        let capacity = Capacity::Triangles(capacity);
        let before = sum(&objects, &chosen(&objects, &capacity, false));
        let turn = turn % objects.len().max(1);
        objects.rotate_left(turn);
        objects.reverse();
        let after = sum(&objects, &chosen(&objects, &capacity, false));
        prop_assert!((before.0 - after.0).abs() <= before.0 * 1e-6 && before.1 == after.1);
    }

    #[test]
    fn values_that_are_not_numbers_count_nothing(capacity in 0..100_u64) {
        let objects = [(f64::NAN, 10), (f64::INFINITY, 10), (-1.0, 10), (f64::NEG_INFINITY, 0), (1.0, 10)];
        let chosen = chosen(&objects, &Capacity::Triangles(capacity), false);
        prop_assert_eq!(chosen.clone(), [capacity >= 30, capacity >= 10, capacity >= 40, true, capacity >= 20]);
    }
}

/// The figures of the documentation: how near to the best possible set, and how much better than stopping at the first
/// misfit. Print them with `cargo test --release -p svs-runtime near_the_optimum -- --nocapture`.
#[test]
fn near_the_optimum() {
    for (count, median_at_least, worst_at_least) in [(8, 0.999, 0.8), (16, 0.999, 0.8), (24, 0.999, 0.8)] {
        let mut random = Random(count as u64);
        let mut shares: Vec<(f64, f64)> = (0..2000)
            .map(|_| {
                loop {
                    let (objects, capacity) = random.scene(count);
                    let best = optimum(&objects, capacity);
                    let share = |published| {
                        sum(&objects, &chosen(&objects, &Capacity::Triangles(capacity), published)).0 / best
                    };
                    if best > 0.0 {
                        break (share(false), share(true));
                    }
                }
            })
            .collect();
        let mut show = |name: &str, key: fn(&(f64, f64)) -> f64| {
            shares.sort_by(|a, b| key(a).total_cmp(&key(b)));
            let at = |share: f64| key(&shares[(share * 1999.0) as usize]);
            let mean = shares.iter().map(key).sum::<f64>() / 2000.0;
            println!(
                "{count} objects, {name}: mean {mean:.5}, median {:.5}, worst 1 % {:.5}, worst {:.5}",
                at(0.5),
                at(0.01),
                at(0.0)
            );
            (at(0.5), at(0.0), mean)
        };
        let ours = show("ours", |s| s.0);
        let published = show("stopping at the first misfit", |s| s.1);
        assert!(ours.0 >= median_at_least && ours.1 >= worst_at_least, "{ours:?}");
        assert!(ours.2 > published.2);
    }
}

/// In scenes of many objects, where no optimum can be found, the relaxed problem bounds it.
#[test]
fn near_the_bound_with_many_objects() {
    let mut random = Random(1);
    for count in [1000, 100_000] {
        let (objects, capacity) = random.scene(count);
        let mut sorted = objects.clone();
        sorted.sort_by(|a, b| (b.0 / f64::from(b.1)).total_cmp(&(a.0 / f64::from(a.1))));
        let (mut bound, mut left) = (0.0, capacity);
        for &(value, triangles) in &sorted {
            if u64::from(triangles) > left {
                bound += value * left as f64 / f64::from(triangles);
                break;
            }
            (bound, left) = (bound + value, left - u64::from(triangles));
        }
        let (value, triangles) = sum(&objects, &chosen(&objects, &Capacity::Triangles(capacity), false));
        println!(
            "{count} objects: {:.7} of the bound, {:.5} of the budget",
            value / bound,
            triangles as f64 / capacity as f64
        );
        assert!(value / bound > 0.999 && triangles <= capacity && triangles as f64 > capacity as f64 * 0.999);
    }
}

/// Prefixes so short that the rest is sorted in the end: never worse than sorting all and taking what fits.
#[test]
fn many_misfits_in_turn() {
    let mut random = Random(2);
    for _ in 0..200 {
        // Worth falls slowly; every second object is too large for what is left.
        let objects: Vec<Object> = (0..80_u32)
            .map(|k| {
                let triangles = if k % 2 == 0 { 10 } else { 100_000 - k * 1000 + random.unit() as u32 * 900 };
                (f64::from(triangles) * (1000.0 - f64::from(k)), triangles)
            })
            .collect();
        let capacity = 100_000 + (random.unit() * 50_000.0) as u64;
        let (mut literal, mut left) = (0.0, capacity);
        for &(value, triangles) in &objects {
            if u64::from(triangles) <= left {
                (literal, left) = (literal + value, left - u64::from(triangles));
            }
        }
        let (value, triangles) = sum(&objects, &chosen(&objects, &Capacity::Triangles(capacity), false));
        assert!(triangles <= capacity && value >= literal * (1.0 - 1e-6), "{value} {literal}");
    }
}
