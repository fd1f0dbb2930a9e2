//! Structural similarity (Wang, Bovik, Sheikh, Simoncelli: Image Quality Assessment, IEEE TIP 13(4), 2004), averaged
//! over an image pyramid as in Eikel's dissertation (2013).

use super::planes::{CENTER, Plane};
use super::{SizeMismatch, same_size};
use rayon::prelude::*;
use svs_render::Image;

/// Window of 11x11 pixels, weighted by a Gaussian of this many pixels.
const SIGMA: f64 = 1.5;
const WINDOW: usize = 11;
/// (0.01 · 255)² and (0.03 · 255)²: keep the quotients finite in flat and dark regions.
const C1: f32 = 6.5025;
const C2: f32 = 58.5225;

/// Similarity of two pictures, -1 to 1; 1 for equal ones.
///
/// SSIM of the luma (BT.709, gamma-encoded, 0 to 255) with an 11x11 Gaussian window of standard deviation 1.5 at all
/// places where it fits, its mean over the picture; then the mean of that over the picture, the picture of half the
/// resolution (means of 2x2 pixels) and so on as long as the window fits. A picture in which it never fits is one window,
/// all pixels weighted alike.
///
/// # Errors
/// [`SizeMismatch`]
pub fn ssim(a: &Image, b: &Image) -> Result<f64, SizeMismatch> {
    same_size(a, b)?;
    if a.rgba == b.rgba {
        return Ok(1.0);
    }
    let luma = |image: &Image| Plane::centered_luma(image.width, image.height, &image.rgba);
    let (mut a, mut b) = rayon::join(|| luma(a), || luma(b));
    if a.width.min(a.height) < WINDOW {
        return Ok(one_window(&a, &b));
    }
    let (mut sum, mut levels) = (0.0, 0);
    loop {
        sum += level(&a, &b);
        levels += 1;
        if a.width.min(a.height) / 2 < WINDOW {
            return Ok(sum / f64::from(levels));
        }
        (a, b) = (a.halved(), b.halved());
    }
}

/// Weighted sums over a window, of values without [`CENTER`]. Of the two variances only the sum is needed.
#[derive(Clone, Copy)]
struct Moments {
    a: f32,
    b: f32,
    squares: f32,
    product: f32,
}

impl Moments {
    fn ssim(self) -> f32 {
        let Self { a, b, squares, product } = self;
        let variances = (squares - a * a - b * b).max(0.0);
        let covariance = product - a * b;
        let (a, b) = (a + CENTER, b + CENTER);
        let likeness =
            (2.0 * a * b + C1) / (a * a + b * b + C1) * ((2.0 * covariance + C2) / (variances + C2));
        // Rounding of nearly equal windows.
        likeness.clamp(-1.0, 1.0)
    }
}

/// Mean over all windows that fit.
fn level(a: &Plane, b: &Plane) -> f64 {
    let kernel = gaussian();
    let (columns, rows) = (a.width - WINDOW + 1, a.height - WINDOW + 1);
    let sums: Vec<f64> = (0..rows)
        .into_par_iter()
        .with_min_len(8)
        .map_init(|| Scratch::new(a.width), |scratch, top| scratch.row(a, b, top, &kernel, columns))
        .collect();
    // Summed in order: the same digits for any number of threads.
    sums.iter().sum::<f64>() / (columns as f64 * rows as f64)
}

fn gaussian() -> [f32; WINDOW] {
    let weight = |i: usize| (-((i as f64 - (WINDOW / 2) as f64) / SIGMA).powi(2) / 2.0).exp();
    let sum: f64 = (0..WINDOW).map(weight).sum();
    std::array::from_fn(|i| (weight(i) / sum) as f32)
}

/// Moments of one row of windows: filtered down the columns, then along the row.
struct Scratch {
    columns: [Vec<f32>; 4],
    windows: [Vec<f32>; 4],
}

impl Scratch {
    fn new(width: usize) -> Self {
        let rows = || std::array::from_fn(|_| vec![0.0; width]);
        Self { columns: rows(), windows: rows() }
    }

    /// Sum of the similarities of `count` windows whose upper edge is row `top`.
    fn row(&mut self, a: &Plane, b: &Plane, top: usize, kernel: &[f32; WINDOW], count: usize) -> f64 {
        if (top..top + WINDOW).all(|y| a.row(y) == b.row(y)) {
            return count as f64;
        }
        let [ca, cb, cs, cp] = &mut self.columns;
        for values in [&mut *ca, cb, cs, cp] {
            values.fill(0.0);
        }
        for (y, &weight) in (top..).zip(kernel) {
            let sums = ca.iter_mut().zip(cb.iter_mut()).zip(cs.iter_mut().zip(cp.iter_mut()));
            for (((ca, cb), (cs, cp)), (&a, &b)) in sums.zip(a.row(y).iter().zip(b.row(y))) {
                let (wa, wb) = (weight * a, weight * b);
                *ca += wa;
                *cb += wb;
                *cs += wa * a + wb * b;
                *cp += wa * b;
            }
        }
        for (windows, columns) in self.windows.iter_mut().zip(&self.columns) {
            let windows = &mut windows[..count];
            windows.fill(0.0);
            for (shift, &weight) in kernel.iter().enumerate() {
                for (sum, &value) in windows.iter_mut().zip(&columns[shift..]) {
                    *sum += weight * value;
                }
            }
        }
        let [wa, wb, ws, wp] = &self.windows;
        let moments = wa.iter().zip(wb).zip(ws.iter().zip(wp)).take(count);
        moments
            .map(|((&a, &b), (&squares, &product))| f64::from(Moments { a, b, squares, product }.ssim()))
            .sum()
    }
}

fn one_window(a: &Plane, b: &Plane) -> f64 {
    let count = a.values.len().max(1) as f64;
    let mean = |of: &dyn Fn(f64, f64) -> f64| {
        let pairs = a.values.iter().zip(&b.values);
        (pairs.map(|(&a, &b)| of(f64::from(a), f64::from(b))).sum::<f64>() / count) as f32
    };
    let moments = Moments {
        a: mean(&|a, _| a),
        b: mean(&|_, b| b),
        squares: mean(&|a, b| a * a + b * b),
        product: mean(&|a, b| a * b),
    };
    f64::from(moments.ssim())
}
