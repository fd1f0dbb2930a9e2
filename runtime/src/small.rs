//! Leaves out the smallest objects, as long as they do not add up.
//!
//! One object of a pixel is not missed, ten thousand of them are a façade: what may be left out is a share of the image, not
//! a size alone.

use crate::hits::Small;

/// Memory of [`Smallest::leave_out`], kept from frame to frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Smallest {
    /// Small ones among what is drawn, ascending.
    pub(crate) list: Vec<Small>,
    sizes: Vec<f32>,
}

impl Smallest {
    /// Allocates nothing for up to so many small things.
    pub(crate) fn with_capacity(things: usize) -> Self {
        Self { list: Vec::with_capacity(things), sizes: Vec::with_capacity(things) }
    }

    /// The next thing to draw, number `at`, is small.
    pub(crate) fn push(&mut self, at: usize, pixels: f32) {
        self.list.push(Small { at: at as u32, pixels });
    }

    /// Takes the smallest ones out of what is drawn, all that have fewer pixels than one size, which is the largest that
    /// leaves out at most `most` pixels in sum. Forgets the list and returns that sum and the size.
    pub(crate) fn leave_out<T: Copy>(&mut self, drawn: &mut Vec<T>, most: f64) -> LeftOut {
        self.sizes.clear();
        self.sizes.extend(self.list.iter().map(|small| small.pixels));
        let left_out = smallest_drawn(&mut self.sizes, most);
        let mut small = self.list.iter().filter(|small| small.pixels < left_out.below).peekable();
        if let Some(first) = small.peek() {
            let mut kept = first.at as usize;
            for at in kept..drawn.len() {
                if small.next_if(|small| small.at as usize == at).is_none() {
                    drawn[kept] = drawn[at];
                    kept += 1;
                }
            }
            drawn.truncate(kept);
        }
        self.list.clear();
        left_out
    }
}

/// What [`Smallest::leave_out`] left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LeftOut {
    /// Small things of fewer pixels were left out.
    pub(crate) below: f32,
    /// Their pixels in sum.
    pub(crate) pixels: f64,
}

/// The largest size below which at most `most` pixels lie, infinite if all may go. Linear: half of what is undecided is looked
/// at each time.
fn smallest_drawn(sizes: &mut [f32], most: f64) -> LeftOut {
    let sum = |sizes: &[f32]| sizes.iter().map(|&size| f64::from(size)).sum::<f64>();
    let (mut low, mut high, mut pixels) = (0, sizes.len(), 0.0);
    while low < high {
        let middle = low + (high - low) / 2;
        sizes[low..high].select_nth_unstable_by(middle - low, f32::total_cmp);
        let with = pixels + sum(&sizes[low..=middle]);
        if with <= most {
            (pixels, low) = (with, middle + 1);
        } else {
            high = middle;
        }
    }
    let Some(&below) = sizes.get(low) else { return LeftOut { below: f32::INFINITY, pixels } };
    // Those as small as the first that is drawn are drawn too.
    let as_small = sum_of_equal(&sizes[..low], below);
    LeftOut { below, pixels: pixels - as_small }
}

fn sum_of_equal(sizes: &[f32], size: f32) -> f64 {
    sizes.iter().filter(|&&other| other == size).map(|&size| f64::from(size)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn leave_out(sizes: &[(bool, f32)], most: f64) -> (Vec<usize>, LeftOut) {
        let mut smallest = Smallest::default();
        for (at, &(_, pixels)) in sizes.iter().enumerate().filter(|(_, size)| size.0) {
            smallest.push(at, pixels);
        }
        let mut drawn: Vec<usize> = (0..sizes.len()).collect();
        let left_out = smallest.leave_out(&mut drawn, most);
        (drawn, left_out)
    }

    #[test]
    fn few_small_things_are_left_out_and_many_are_not() {
        let few = [(true, 1.0), (false, 0.5), (true, 0.5)];
        assert_eq!(leave_out(&few, 2.0), (vec![1], LeftOut { below: f32::INFINITY, pixels: 1.5 }));
        let many = [(true, 1.0); 100];
        assert_eq!(leave_out(&many, 99.0), ((0..100).collect(), LeftOut { below: 1.0, pixels: 0.0 }));
        assert!(leave_out(&many, 100.0).0.is_empty());
    }

    proptest! {
        /// What is left out is small, in sum too, smaller than all small things that stay, and no more of them could go.
        #[test]
        fn the_smallest_go_and_no_more_could(
            sizes in prop::collection::vec((any::<bool>(), prop_oneof![0.0_f32..4.0, Just(1.0)]), 0..80),
            most in 0.0_f64..80.0,
        ) {
            let (drawn, left_out) = leave_out(&sizes, most);
            prop_assert!(drawn.is_sorted());
            let gone: Vec<usize> = (0..sizes.len()).filter(|at| !drawn.contains(at)).collect();
            prop_assert!(gone.iter().all(|&at| sizes[at].0 && sizes[at].1 < left_out.below));
            prop_assert!(drawn.iter().all(|&at| !sizes[at].0 || sizes[at].1 >= left_out.below));
            let sum: f64 = gone.iter().map(|&at| f64::from(sizes[at].1)).sum();
            prop_assert!(sum <= most + 1e-9 && (sum - left_out.pixels).abs() < 1e-9);
            let next: f64 = drawn
                .iter()
                .filter(|&&at| sizes[at].0 && sizes[at].1 == left_out.below)
                .map(|&at| f64::from(sizes[at].1))
                .sum();
            prop_assert!(left_out.below == f32::INFINITY || sum + next > most - 1e-9);
        }
    }
}
