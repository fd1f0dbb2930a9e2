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
    /// Pixels per class of sizes.
    sums: Vec<f64>,
}

impl Smallest {
    /// Allocates nothing for up to so many small things.
    pub(crate) fn with_capacity(things: usize) -> Self {
        Self { list: Vec::with_capacity(things), sums: vec![0.0; CLASSES] }
    }

    /// The next thing to draw, number `at`, is small; a size that is no number counts as 0.
    pub(crate) fn push(&mut self, at: usize, pixels: f32) {
        self.list.push(Small { at: at as u32, pixels: pixels.max(0.0) });
    }

    /// Takes the smallest ones out of what is drawn: all of the lowest classes of sizes that have at most `most` pixels in
    /// sum. Forgets the list.
    pub(crate) fn leave_out<T: Copy>(&mut self, drawn: &mut Vec<T>, most: f64) -> LeftOut {
        let left_out = self.lowest_classes(most);
        let mut small = self.list.iter().filter(|small| left_out.has(small.pixels)).peekable();
        if let Some(first) = small.peek() {
            let first = first.at as usize;
            let mut kept = first;
            for at in first..drawn.len() {
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

    fn lowest_classes(&mut self, most: f64) -> LeftOut {
        let mut left_out = LeftOut { classes: CLASSES, pixels: 0.0 };
        if self.list.is_empty() {
            return left_out;
        }
        self.sums.clear();
        self.sums.resize(CLASSES, 0.0);
        for small in &self.list {
            self.sums[class(small.pixels)] += f64::from(small.pixels);
        }
        for (class, sum) in self.sums.iter().enumerate() {
            if left_out.pixels + sum > most {
                left_out.classes = class;
                break;
            }
            left_out.pixels += sum;
        }
        left_out
    }
}

/// What [`Smallest::leave_out`] left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LeftOut {
    /// Sizes of the lowest so many classes.
    classes: usize,
    /// Their pixels in sum.
    pub(crate) pixels: f64,
}

impl LeftOut {
    /// A small thing of this size was left out.
    pub(crate) fn has(&self, pixels: f32) -> bool {
        class(pixels) < self.classes
    }
}

/// Classes of sizes, eight to an octave: numbers that are not negative are ordered as their bits are, and those begin with the
/// exponent.
const CLASSES: usize = 1 << 11;

fn class(pixels: f32) -> usize {
    (pixels.to_bits() >> 20) as usize
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
        let (drawn, left_out) = leave_out(&[(true, 1.0), (false, 0.5), (true, 0.5)], 2.0);
        assert_eq!((drawn, left_out.pixels), (vec![1], 1.5));
        let many = [(true, 1.0); 100];
        let (drawn, left_out) = leave_out(&many, 99.0);
        assert_eq!(
            (drawn.len(), left_out.pixels, left_out.has(1.0), left_out.has(0.9)),
            (100, 0.0, false, true)
        );
        assert!(leave_out(&many, 100.0).0.is_empty());
        assert_eq!(leave_out(&[(true, f32::INFINITY), (true, 0.0), (true, f32::NAN)], 1.0).0, [0]);
        assert!(leave_out(&[(true, f32::INFINITY)], f64::INFINITY).0.is_empty());
    }

    proptest! {
        /// What is left out is small, in sum too; all smaller small things go with it, and none of the next class could.
        #[test]
        fn the_smallest_go_and_no_more_could(
            sizes in prop::collection::vec((any::<bool>(), prop_oneof![0.0_f32..4.0, Just(1.0)]), 0..80),
            most in 0.0_f64..80.0,
        ) {
            let (drawn, left_out) = leave_out(&sizes, most);
            prop_assert!(drawn.is_sorted());
            let small = |at: &usize| sizes[*at].0;
            let size = |at: &usize| f64::from(sizes[*at].1);
            let (gone, kept): (Vec<usize>, Vec<usize>) = (0..sizes.len()).partition(|at| !drawn.contains(at));
            prop_assert!(gone.iter().all(small));
            let largest = gone.iter().map(size).fold(0.0, f64::max);
            let kept: Vec<usize> = kept.into_iter().filter(small).collect();
            prop_assert!(kept.iter().all(|at| size(at) >= largest && !left_out.has(sizes[*at].1)));
            let sum: f64 = gone.iter().map(size).sum();
            prop_assert!(sum <= most + 1e-9 && (sum - left_out.pixels).abs() < 1e-9);
            let least = kept.iter().map(|&at| class(sizes[at].1)).min();
            let next: f64 = kept.iter().filter(|&&at| Some(class(sizes[at].1)) == least).map(size).sum();
            prop_assert!(kept.is_empty() || sum + next > most - 1e-9);
        }
    }
}
