//! Screenshots.

use crate::run::{Stand, finish};
use image::RgbImage;
use serde_json::json;

impl Stand {
    pub(crate) fn picture(&self, name: &str) -> RgbImage {
        image::open(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}")).into_rgb8()
    }

    /// Share of a picture's pixels that are of some kind.
    pub(crate) fn share(&self, name: &str, is: impl Fn([u8; 3]) -> bool) -> f64 {
        let picture = self.picture(name);
        picture.pixels().filter(|pixel| is(pixel.0)).count() as f64
            / f64::from(picture.width() * picture.height())
    }

    /// Share of pixels in which two pictures differ visibly.
    pub(crate) fn differing(&self, a: &RgbImage, b: &RgbImage) -> f64 {
        assert_eq!(a.dimensions(), b.dimensions());
        let differ =
            |(a, b): (&image::Rgb<u8>, &image::Rgb<u8>)| (0..3).any(|c| a.0[c].abs_diff(b.0[c]) > 24);
        a.pixels().zip(b.pixels()).filter(|&pair| differ(pair)).count() as f64 / a.pixels().len() as f64
    }
}

#[test]
fn a_screenshot_shows_scene_and_panel() {
    let stand = Stand::new();
    let boxes = stand.sample("boxes", "0.02");
    let child = stand
        .viewer(&boxes)
        .args(["--size", "900x600", "--after", "3", "--screenshot", "window.png"])
        .spawn()
        .expect("svs starts");
    let output = finish(child);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let picture = stand.picture("window.png");
    assert_eq!(picture.dimensions(), (900, 600));
    let colours = |from: u32, to: u32| {
        let mut colours: Vec<[u8; 3]> = picture
            .enumerate_pixels()
            .filter(|(x, ..)| (from..to).contains(x))
            .map(|(_, _, pixel)| pixel.0)
            .collect();
        colours.sort_unstable();
        colours.dedup();
        colours.len()
    };
    // Boxes before a sky with a gradient, and text on the panel.
    assert!(colours(0, 570) > 20 && colours(580, 900) > 20, "{} {}", colours(0, 570), colours(580, 900));
}

#[test]
fn the_window_can_be_resized() {
    let stand = Stand::new();
    let boxes = stand.sample("boxes", "0.02");
    stand.script(
        &boxes,
        &json!([{"frames": 2}, {"resize": [700, 500]}, {"frames": 3}, {"screenshot": "small.png"}, {"dump": "small.json"},
                {"resize": [1100, 700]}, {"frames": 3}, {"screenshot": "large.png"}]),
    );
    assert_eq!(stand.picture("small.png").dimensions(), (700, 500));
    assert_eq!(stand.dump("small.json")["viewport"], json!([700 - 328, 500]));
    assert_eq!(stand.picture("large.png").dimensions(), (1100, 700));
}
