//! Smaller versions of images, averaged in linear light.

use crate::Image;

/// sRGB to linear, for all bytes.
fn linear_table() -> [f32; 256] {
    std::array::from_fn(|byte| {
        let c = byte as f32 / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    })
}

fn srgb_byte(linear: f32) -> u8 {
    let c = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    crate::vertex::unorm8(c)
}

/// `image` halved until it is one texel; the image itself is not in the list.
pub(crate) fn smaller(image: &Image, srgb: bool) -> Vec<Image> {
    let table = linear_table();
    let mut levels: Vec<Image> = Vec::new();
    loop {
        let last = levels.last().unwrap_or(image);
        if last.width == 1 && last.height == 1 {
            return levels;
        }
        levels.push(halve(last, srgb.then_some(&table)));
    }
}

fn halve(image: &Image, table: Option<&[f32; 256]>) -> Image {
    let (width, height) = ((image.width / 2).max(1), (image.height / 2).max(1));
    let mut rgba = Vec::with_capacity(width as usize * height as usize * 4);
    for y in 0..height {
        for x in 0..width {
            let texel = |dx: u32, dy: u32| {
                let (x, y) = ((x * 2 + dx).min(image.width - 1), (y * 2 + dy).min(image.height - 1));
                let at = (y as usize * image.width as usize + x as usize) * 4;
                [image.rgba[at], image.rgba[at + 1], image.rgba[at + 2], image.rgba[at + 3]]
            };
            let four = [texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)];
            for channel in 0..4 {
                rgba.push(match table {
                    Some(table) if channel < 3 => {
                        srgb_byte(four.iter().map(|t| table[t[channel] as usize]).sum::<f32>() / 4.0)
                    }
                    _ => ((four.iter().map(|t| u32::from(t[channel])).sum::<u32>() + 2) / 4) as u8,
                });
            }
        }
    }
    Image { width, height, rgba }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_halve_to_one_texel_and_average_light() {
        let mut rgba = vec![0; 5 * 2 * 4];
        for texel in rgba.chunks_exact_mut(8) {
            texel.copy_from_slice(&[255, 255, 255, 255, 0, 0, 0, 255]);
        }
        let levels = smaller(&Image { width: 5, height: 2, rgba }, true);
        assert_eq!(levels.iter().map(|l| (l.width, l.height)).collect::<Vec<_>>(), [(2, 1), (1, 1)]);
        // Half the light is byte 188 in sRGB.
        assert_eq!(levels[1].rgba, [188, 188, 188, 255]);
    }

    #[test]
    fn data_is_averaged_as_it_is() {
        let rgba = [[0u8, 10, 20, 30], [100, 110, 120, 130]].concat();
        assert_eq!(smaller(&Image { width: 2, height: 1, rgba }, false)[0].rgba, [50, 60, 70, 80]);
    }
}
