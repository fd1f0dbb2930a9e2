//! Brightness of pictures, and ever smaller pictures.

use rayon::prelude::*;

/// Weights of red, green and blue in the luma Y' (ITU-R BT.709, whose primaries sRGB has). They apply to the stored,
/// gamma-encoded values; 0 to 255.
pub(super) const LUMA: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// One value per pixel, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) values: Vec<f32>,
}

impl Plane {
    /// Luma of a picture of four bytes a pixel, moved by -128: small numbers keep more digits when they are squared.
    pub(super) fn centered_luma(width: u32, height: u32, rgba: &[u8]) -> Self {
        let luma = |texel: &[u8]| {
            LUMA[0] * f32::from(texel[0]) + LUMA[1] * f32::from(texel[1]) + LUMA[2] * f32::from(texel[2])
                - CENTER
        };
        let values = rgba.par_chunks_exact(4).with_min_len(1 << 14).map(luma).collect();
        Self { width: width as usize, height: height as usize, values }
    }

    /// Half the width and height, each value the mean of four; an odd last row or column is left out.
    pub(super) fn halved(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let mut values = vec![0.0; width * height];
        values.par_chunks_exact_mut(width.max(1)).with_min_len(32).enumerate().for_each(|(y, row)| {
            let (upper, lower) = (self.row(2 * y), self.row(2 * y + 1));
            for (value, (a, b)) in row.iter_mut().zip(upper.chunks_exact(2).zip(lower.chunks_exact(2))) {
                *value = (a[0] + a[1] + b[0] + b[1]) * 0.25;
            }
        });
        Self { width, height, values }
    }

    pub(super) fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.width..][..self.width]
    }
}

/// What [`Plane::centered_luma`] takes off.
pub(super) const CENTER: f32 = 128.0;
