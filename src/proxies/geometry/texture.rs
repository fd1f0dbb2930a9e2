//! Small linear copies of images, at all sizes: what a texture looks like on average around a point.

use svs_render::{Image, Sampler, Wrap};

/// Largest width and height that is kept: vertices are coarser than texels anyway.
const LARGEST: u32 = 256;

/// One image at all sizes.
#[derive(Clone, Debug)]
pub(super) struct Pyramid {
    levels: Vec<Level>,
    /// Lowest alpha of all texels, 0 to 1.
    pub(super) least_alpha: f32,
    /// Standard deviation of brightness, in steps of sRGB from 0 to 1.
    pub(super) spread: f32,
}

#[derive(Clone, Debug)]
struct Level {
    width: u32,
    height: u32,
    /// Linear, alpha as it is.
    texels: Vec<[f32; 4]>,
}

impl Pyramid {
    /// `None` for an image without texels.
    pub(super) fn new(image: &Image, srgb: bool) -> Option<Self> {
        let (width, height) = (image.width, image.height);
        let texels = u64::from(width) * u64::from(height);
        if texels == 0 || (image.rgba.len() as u64) < texels * 4 {
            return None;
        }
        let table: Vec<f32> = (0..=255u8)
            .map(|c| if srgb { linear(f32::from(c) / 255.0) } else { f32::from(c) / 255.0 })
            .collect();
        let texel = |x: u32, y: u32| {
            let at = (y as usize * width as usize + x as usize) * 4;
            let [r, g, b] = [0, 1, 2].map(|c| table[usize::from(image.rgba[at + c])]);
            [r, g, b, f32::from(image.rgba[at + 3]) / 255.0]
        };
        let base = shrink(width, height, width.min(LARGEST), height.min(LARGEST), texel);
        let spread = spread(&base.texels);
        let mut levels = vec![base];
        while let Some(last) = levels.last()
            && (last.width > 1 || last.height > 1)
        {
            let at = |x: u32, y: u32| last.texels[(y * last.width + x) as usize];
            levels.push(shrink(last.width, last.height, last.width.div_ceil(2), last.height.div_ceil(2), at));
        }
        let alpha = image.rgba.iter().skip(3).step_by(4).take(texels as usize).min();
        Some(Self { levels, least_alpha: f32::from(alpha.copied().unwrap_or(255)) / 255.0, spread })
    }

    /// The mean of the whole image, linear.
    pub(super) fn mean(&self) -> [f32; 4] {
        self.levels.last().map_or([1.0; 4], |level| level.texels[0])
    }

    /// Linear colour around `uv`, averaged over about `footprint` (part of the image's width or height).
    pub(super) fn sample(&self, sampler: Sampler, uv: [f32; 2], footprint: f32) -> [f32; 4] {
        let wide_enough = |level: &&Level| footprint * (level.width.max(level.height) as f32) <= 1.0;
        let Some(level) = self.levels.iter().find(wide_enough).or(self.levels.last()) else {
            return [1.0; 4];
        };
        if !uv[0].is_finite() || !uv[1].is_finite() {
            return self.mean();
        }
        let x = uv[0] * level.width as f32 - 0.5;
        let y = uv[1] * level.height as f32 - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let (right_share, bottom_share) = (x - left, y - top);
        let mut sum = [0.0; 4];
        for (dx, dy, share) in [
            (0.0, 0.0, (1.0 - right_share) * (1.0 - bottom_share)),
            (1.0, 0.0, right_share * (1.0 - bottom_share)),
            (0.0, 1.0, (1.0 - right_share) * bottom_share),
            (1.0, 1.0, right_share * bottom_share),
        ] {
            let column = wrap(left + dx, level.width, sampler.wrap_u);
            let row = wrap(top + dy, level.height, sampler.wrap_v);
            let texel = level.texels[row * level.width as usize + column];
            for (sum, part) in sum.iter_mut().zip(texel) {
                *sum += part * share;
            }
        }
        sum
    }
}

fn wrap(place: f32, count: u32, wrap: Wrap) -> usize {
    let count = i64::from(count);
    let place = place as i64;
    let place = match wrap {
        Wrap::Repeat => place.rem_euclid(count),
        Wrap::Clamp => place.clamp(0, count - 1),
        Wrap::Mirror => {
            let turn = place.rem_euclid(2 * count);
            if turn < count { turn } else { 2 * count - 1 - turn }
        }
    };
    place as usize
}

/// Averages boxes of texels; colours count by their alpha.
fn shrink(
    width: u32,
    height: u32,
    to_width: u32,
    to_height: u32,
    at: impl Fn(u32, u32) -> [f32; 4],
) -> Level {
    let edges = |i: u32, from: u32, to: u32| {
        let edge = |i: u32| (u64::from(i) * u64::from(from) / u64::from(to)) as u32;
        edge(i)..edge(i + 1).max(edge(i) + 1).min(from)
    };
    let mut texels = Vec::with_capacity(to_width as usize * to_height as usize);
    for row in 0..to_height {
        for column in 0..to_width {
            let (mut color, mut plain, mut alpha, mut count) = ([0.0f64; 3], [0.0f64; 3], 0.0f64, 0.0f64);
            for y in edges(row, height, to_height) {
                for x in edges(column, width, to_width) {
                    let texel = at(x, y).map(f64::from);
                    for c in 0..3 {
                        color[c] += texel[c] * texel[3];
                        plain[c] += texel[c];
                    }
                    alpha += texel[3];
                    count += 1.0;
                }
            }
            let color = if alpha > 0.0 { color.map(|c| c / alpha) } else { plain.map(|c| c / count) };
            texels.push([color[0] as f32, color[1] as f32, color[2] as f32, (alpha / count) as f32]);
        }
    }
    Level { width: to_width, height: to_height, texels }
}

fn spread(texels: &[[f32; 4]]) -> f32 {
    let (mut sum, mut squares) = (0.0f64, 0.0f64);
    for texel in texels {
        let luminance = 0.2126 * texel[0] + 0.7152 * texel[1] + 0.0722 * texel[2];
        let value = f64::from(encoded(luminance));
        sum += value;
        squares += value * value;
    }
    let count = texels.len().max(1) as f64;
    ((squares / count - (sum / count).powi(2)).max(0.0)).sqrt() as f32
}

/// sRGB to linear, 0 to 1.
fn linear(value: f32) -> f32 {
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Linear to sRGB, 0 to 1.
fn encoded(value: f32) -> f32 {
    if value <= 0.003_130_8 { value * 12.92 } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}
