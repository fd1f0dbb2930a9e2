//! Peak signal-to-noise ratio of brightness and colour.

use super::planes::LUMA;
use super::{SizeMismatch, same_size};
use rayon::prelude::*;
use svs_render::Image;

/// Peak signal-to-noise ratios, decibels, 0 to [`MAX_PSNR`]; higher is better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Psnr {
    /// Of the luma Y'.
    pub y: f64,
    /// Of the blue difference Cb.
    pub cb: f64,
    /// Of the red difference Cr.
    pub cr: f64,
}

/// What equal pictures have, and the most any have, decibels: their true ratio is infinite, which neither a median nor JSON
/// can hold. One step of one colour in a single pixel of 1280x720 is about 108 dB in luma.
pub const MAX_PSNR: f64 = 120.0;

/// Rows summed by one task at least.
const PIXELS_PER_TASK: usize = 1 << 14;

/// Compares two pictures in the colour space Y'CbCr of ITU-R BT.709, full range, peak 255, of the stored (gamma-encoded)
/// values, without rounding.
///
/// # Errors
/// [`SizeMismatch`]
pub fn psnr(a: &Image, b: &Image) -> Result<Psnr, SizeMismatch> {
    same_size(a, b)?;
    let chunks = a.rgba.par_chunks(4 * PIXELS_PER_TASK).zip(b.rgba.par_chunks(4 * PIXELS_PER_TASK));
    let sums: Vec<[f64; 3]> = chunks.map(|(a, b)| squares(a, b)).collect();
    let pixels = a.rgba.len() as f64 / 4.0;
    let ratio = |channel: usize| {
        let error = sums.iter().map(|sum| sum[channel]).sum::<f64>() / pixels.max(1.0);
        if error > 0.0 { (10.0 * (255.0 * 255.0 / error).log10()).clamp(0.0, MAX_PSNR) } else { MAX_PSNR }
    };
    Ok(Psnr { y: ratio(0), cb: ratio(1), cr: ratio(2) })
}

/// Sums of the squared differences of Y', Cb and Cr. They are linear in the colours, so their differences come from those
/// of the colours.
fn squares(a: &[u8], b: &[u8]) -> [f64; 3] {
    let [red, green, blue] = LUMA.map(f64::from);
    let mut sums = [0.0; 3];
    for (a, b) in a.chunks_exact(4).zip(b.chunks_exact(4)) {
        if a == b {
            continue;
        }
        let difference = |channel: usize| f64::from(a[channel]) - f64::from(b[channel]);
        let y = red * difference(0) + green * difference(1) + blue * difference(2);
        let cb = (difference(2) - y) / (2.0 * (1.0 - blue));
        let cr = (difference(0) - y) / (2.0 * (1.0 - red));
        for (sum, value) in sums.iter_mut().zip([y, cb, cr]) {
            *sum += value * value;
        }
    }
    sums
}
