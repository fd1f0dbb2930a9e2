//! The measures against hand-computed cases and a plain implementation of their definitions.

use super::*;
use proptest::prelude::*;
use svs_render::{Image, ItemBuffer};

fn picture(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 3]) -> Image {
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let rgba = texels.flat_map(|(x, y)| {
        let [r, g, b] = texel(x, y);
        [r, g, b, 255]
    });
    Image { width, height, rgba: rgba.collect() }
}

fn grey(width: u32, height: u32, value: u8) -> Image {
    picture(width, height, |_, _| [value; 3])
}

/// Noise that is the same everywhere.
fn noise(seed: u32, x: u32, y: u32) -> u8 {
    let mut state = seed ^ x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b);
    for shift in [16, 13, 16] {
        state = (state ^ (state >> shift)).wrapping_mul(0x7feb_352d);
    }
    (state >> 24) as u8
}

/// Structural similarity as the papers write it: in double precision, window by window, two variances.
fn plain_ssim(a: &Image, b: &Image) -> f64 {
    let luma = |image: &Image| -> Vec<f64> {
        let texel = |t: &[u8]| 0.2126 * f64::from(t[0]) + 0.7152 * f64::from(t[1]) + 0.0722 * f64::from(t[2]);
        image.rgba.chunks_exact(4).map(texel).collect()
    };
    let halve = |values: &[f64], width: usize, height: usize| -> Vec<f64> {
        let places = (0..height / 2).flat_map(|y| (0..width / 2).map(move |x| 2 * y * width + 2 * x));
        places
            .map(|i| (values[i] + values[i + 1] + values[i + width] + values[i + width + 1]) / 4.0)
            .collect()
    };
    let (mut width, mut height) = (a.width as usize, a.height as usize);
    let (mut a, mut b) = (luma(a), luma(b));
    let mut means = Vec::new();
    while width.min(height) >= 11 {
        let mut sum = 0.0;
        for top in 0..=height - 11 {
            for left in 0..=width - 11 {
                sum += plain_window(&a, &b, width, left, top);
            }
        }
        means.push(sum / ((width - 10) * (height - 10)) as f64);
        (a, b) = (halve(&a, width, height), halve(&b, width, height));
        (width, height) = (width / 2, height / 2);
    }
    means.iter().sum::<f64>() / means.len() as f64
}

fn plain_window(a: &[f64], b: &[f64], width: usize, left: usize, top: usize) -> f64 {
    let mut weighted = Vec::new();
    for y in 0..11 {
        for x in 0..11 {
            let distance = (x as f64 - 5.0).powi(2) + (y as f64 - 5.0).powi(2);
            let place = (top + y) * width + left + x;
            weighted.push(((-distance / (2.0 * 1.5 * 1.5)).exp(), a[place], b[place]));
        }
    }
    let total: f64 = weighted.iter().map(|w| w.0).sum();
    let mean =
        |of: &dyn Fn(f64, f64) -> f64| weighted.iter().map(|w| w.0 * of(w.1, w.2)).sum::<f64>() / total;
    let (ma, mb) = (mean(&|a, _| a), mean(&|_, b| b));
    let (va, vb) = (mean(&|a, _| (a - ma).powi(2)), mean(&|_, b| (b - mb).powi(2)));
    let covariance = mean(&|a, b| (a - ma) * (b - mb));
    let (c1, c2) = ((0.01_f64 * 255.0).powi(2), (0.03_f64 * 255.0).powi(2));
    (2.0 * ma * mb + c1) * (2.0 * covariance + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2))
}

#[test]
fn equal_pictures_are_perfect() {
    for (width, height) in [(1, 1), (10, 40), (11, 11), (97, 61)] {
        let image = picture(width, height, |x, y| [noise(1, x, y), noise(2, x, y), noise(3, x, y)]);
        assert_eq!(ssim(&image, &image), Ok(1.0));
        assert_eq!(psnr(&image, &image), Ok(Psnr { y: MAX_PSNR, cb: MAX_PSNR, cr: MAX_PSNR }));
    }
}

#[test]
fn black_and_white_are_as_far_apart_as_can_be() {
    let (black, white) = (grey(64, 48, 0), grey(64, 48, 255));
    // Flat: only the term of the means is left, C1 / (255² + C1).
    assert!((ssim(&black, &white).unwrap() - 6.5025 / (65025.0 + 6.5025)).abs() < 1e-6);
    assert!((ssim(&grey(5, 5, 0), &grey(5, 5, 255)).unwrap() - 6.5025 / (65025.0 + 6.5025)).abs() < 1e-6);
    let psnr = psnr(&black, &white).unwrap();
    assert!(psnr.y.abs() < 1e-9, "{psnr:?}");
    // Grey has no colour.
    assert_eq!((psnr.cb, psnr.cr), (MAX_PSNR, MAX_PSNR));
}

#[test]
fn a_constant_shift_is_known_exactly() {
    let (a, b) = (grey(80, 60, 100), grey(80, 60, 110));
    let expected = (2.0 * 100.0 * 110.0 + 6.5025) / (100.0 * 100.0 + 110.0 * 110.0 + 6.5025);
    assert!((ssim(&a, &b).unwrap() - expected).abs() < 1e-5);
    assert!((psnr(&a, &b).unwrap().y - 10.0 * (65025.0_f64 / 100.0).log10()).abs() < 1e-9);
}

#[test]
fn colours_are_those_of_bt_709() {
    let (black, blue) = (grey(8, 8, 0), picture(8, 8, |_, _| [0, 0, 255]));
    let psnr = psnr(&black, &blue).unwrap();
    // Pure blue: Y' = 0.0722, Cb = 0.5, Cr = -0.0722 / 1.5748, of 255.
    let decibels = |share: f64| -20.0 * share.log10();
    assert!((psnr.y - decibels(0.0722)).abs() < 1e-4, "{psnr:?}");
    assert!((psnr.cb - decibels(0.5)).abs() < 1e-4, "{psnr:?}");
    assert!((psnr.cr - decibels(0.0722 / 1.5748)).abs() < 1e-4, "{psnr:?}");
}

#[test]
fn one_step_in_one_pixel_is_below_the_cap() {
    let a = grey(1280, 720, 90);
    let mut b = a.clone();
    b.rgba[4..7].copy_from_slice(&[91, 91, 91]);
    let y = psnr(&a, &b).unwrap().y;
    assert!((107.0..MAX_PSNR).contains(&y), "{y}");
    let similarity = ssim(&a, &b).unwrap();
    assert!((0.999_99..1.0).contains(&similarity), "{similarity}");
}

#[test]
fn the_negative_is_less_than_unlike() {
    let a = picture(64, 64, |x, y| [if noise(1, x, y) < 128 { 100 } else { 156 }; 3]);
    let b = picture(64, 64, |x, y| [if noise(1, x, y) < 128 { 156 } else { 100 }; 3]);
    // Level by level the contrast sinks towards the constants, but the sign stays.
    assert!(ssim(&a, &b).unwrap() < -0.2);
}

#[test]
fn sizes_must_agree() {
    let broken = Image { width: 8, height: 8, rgba: vec![0; 8] };
    for other in [grey(8, 9, 0), grey(4, 16, 0), broken] {
        assert!(ssim(&grey(8, 8, 0), &other).is_err());
        assert!(psnr(&grey(8, 8, 0), &other).is_err());
    }
    let empty = Image::default();
    assert_eq!((ssim(&empty, &empty), psnr(&empty, &empty).map(|p| p.y)), (Ok(1.0), Ok(MAX_PSNR)));
}

#[test]
fn a_full_picture_takes_well_under_a_tenth_of_a_second() {
    let a = picture(1280, 720, |x, y| [noise(1, x / 3, y / 3); 3]);
    let b = picture(1280, 720, |x, y| [noise(2, x / 3, y / 3); 3]);
    // The fastest of a few: other programs may be busy.
    let seconds = (0..8).map(|_| {
        let start = std::time::Instant::now();
        assert!(ssim(&a, &b).unwrap() < 0.5);
        start.elapsed().as_secs_f64()
    });
    let fastest = seconds.fold(f64::INFINITY, f64::min);
    println!("SSIM of 1280x720: {:.1} ms", fastest * 1e3);
    assert!(cfg!(debug_assertions) || fastest < 0.25, "{fastest} s");
}

const NONE: u32 = u32::MAX;

#[test]
fn missing_and_overdrawn_objects_are_counted() {
    // Object 7 is glass before object 3 and before nothing.
    let items = |nearest: &[u32], transparent: &[u32]| ItemBuffer {
        width: nearest.len() as u32,
        height: 1,
        nearest: nearest.to_vec(),
        transparent: transparent.to_vec(),
    };
    let nearest = [3, 3, 5, NONE, 3, NONE];
    let transparent = [7, NONE, NONE, 7, NONE, NONE];
    let seen = Seen::new(items(&nearest, &transparent));
    assert_eq!(seen.objects, [3, 5, 7]);
    assert_eq!(seen.compare(&[7, 5, 3]), Compared::default());
    assert_eq!(seen.compare(&[9, 5, 7, 3, 1]), Compared { overdrawn: 2, ..Compared::default() });
    // The first pixel shows both missing objects and counts once.
    let compared = seen.compare(&[5, 2]);
    assert_eq!(compared, Compared { missing: vec![(3, 3), (7, 2)], pixels: 4, overdrawn: 1 });
    assert_eq!(seen.compare(&[]).pixels, 5);
    assert_eq!(seen.mask(&[3, 7]), [true, true, false, true, true, false]);
    assert_eq!(
        Seen::new(items(&[NONE], &[NONE])).compare(&[4]),
        Compared { overdrawn: 1, ..Compared::default() }
    );
}

/// Two pictures: noise of some strength over a gradient, an equal part at the top.
fn pair() -> impl Strategy<Value = (Image, Image)> {
    (1_u32..48, 1_u32..48, any::<[u32; 2]>(), 1_u32..=256, 0_u32..48).prop_map(
        |(width, height, seeds, strength, equal)| {
            let texel = move |seed: u32| {
                move |x: u32, y: u32| {
                    let seed = if y < equal { 1 } else { seed };
                    [0, 1, 2].map(|c| {
                        ((x * 3 + y * 2) % 256 * (256 - strength) / 256
                            + u32::from(noise(seed + c, x, y)) * strength / 256) as u8
                    })
                }
            };
            let seeds = seeds.map(|seed| seed % 1_000_000);
            (picture(width, height, texel(seeds[0])), picture(width, height, texel(seeds[1])))
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn ssim_is_its_definition((a, b) in pair()) {
        let (ab, ba) = (ssim(&a, &b).unwrap(), ssim(&b, &a).unwrap());
        prop_assert!((-1.0..=1.0).contains(&ab), "{ab}");
        prop_assert!((ab - ba).abs() < 1e-6, "{ab} and {ba}");
        if a.width.min(a.height) >= 11 {
            let plain = plain_ssim(&a, &b);
            prop_assert!((ab - plain).abs() < 2e-5, "{ab} for {plain}");
        }
    }

    #[test]
    fn psnr_is_finite_and_symmetric((a, b) in pair()) {
        let (ab, ba) = (psnr(&a, &b).unwrap(), psnr(&b, &a).unwrap());
        for value in [ab.y, ab.cb, ab.cr] {
            prop_assert!((0.0..=MAX_PSNR).contains(&value), "{ab:?}");
        }
        prop_assert_eq!(ab, ba);
    }
}
