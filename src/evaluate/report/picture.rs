//! Pictures of the report: made smaller, with what is missing marked, as PNG in a data URI.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::imageops::{self, FilterType as Resampling};
use image::{DynamicImage, ImageEncoder as _, Rgb, RgbImage, RgbaImage};
use svs_render::Image;

/// Most pixels a row of the report's pictures.
const MOST_WIDTH: u32 = 560;

/// Colour of missing pixels: nothing in a grey picture looks like it.
const MARK: Rgb<u8> = Rgb([214, 0, 127]);

/// A picture as a data URI; `None` if it has no pixels.
pub(super) fn data_uri(picture: &Image) -> Option<String> {
    png(&smaller(picture)?)
}

/// The picture in pale grey, missing pixels in magenta, each group of them in a box. One missing pixel can be seen.
pub(super) fn marked_uri(picture: &Image, missing: &[bool]) -> Option<String> {
    let mut small = smaller(picture)?;
    let (width, height) = small.dimensions();
    for pixel in small.pixels_mut() {
        let [r, g, b] = pixel.0.map(u32::from);
        let grey = (54 * r + 183 * g + 19 * b) / 256;
        *pixel = Rgb([(128 + grey / 2).min(255) as u8; 3]);
    }
    let marks = shrunk(missing, picture.width, picture.height, width, height);
    for frame in boxes(&marks, width, height) {
        outline(&mut small, frame);
    }
    for (pixel, _) in small.pixels_mut().zip(&marks).filter(|(_, mark)| **mark) {
        *pixel = MARK;
    }
    png(&small)
}

fn smaller(picture: &Image) -> Option<RgbImage> {
    let whole = RgbaImage::from_raw(picture.width, picture.height, picture.rgba.clone())?;
    let whole = DynamicImage::ImageRgba8(whole).into_rgb8();
    if picture.width == 0 || picture.height == 0 {
        return None;
    }
    if picture.width <= MOST_WIDTH {
        return Some(whole);
    }
    let height = u64::from(picture.height) * u64::from(MOST_WIDTH) / u64::from(picture.width);
    Some(imageops::resize(&whole, MOST_WIDTH, (height as u32).max(1), Resampling::Triangle))
}

/// A mask of another size: a pixel is set if any pixel it covers was.
fn shrunk(mask: &[bool], width: u32, height: u32, new_width: u32, new_height: u32) -> Vec<bool> {
    let mut marks = vec![false; new_width as usize * new_height as usize];
    let scale = |at: usize, from: u32, to: u32| (at as u64 * u64::from(to) / u64::from(from.max(1))) as usize;
    for (place, _) in mask.iter().enumerate().filter(|(_, set)| **set) {
        let (x, y) = (place % width.max(1) as usize, place / width.max(1) as usize);
        let at = scale(y, height, new_height) * new_width as usize + scale(x, width, new_width);
        if let Some(mark) = marks.get_mut(at) {
            *mark = true;
        }
    }
    marks
}

/// A box around a group of marks: left, top, right, bottom, in pixels.
type Box = [u32; 4];

/// Marks nearer to each other than this share a box, pixels.
const GROUP: u32 = 16;
/// Space between marks and their box.
const MARGIN: u32 = 5;

/// Boxes around groups of marks, found on a grid of cells.
fn boxes(marks: &[bool], width: u32, height: u32) -> Vec<Box> {
    let (columns, rows) = (width.div_ceil(GROUP) as usize, height.div_ceil(GROUP) as usize);
    let mut cells: Vec<Option<Box>> = vec![None; columns * rows];
    for (place, _) in marks.iter().enumerate().filter(|(_, mark)| **mark) {
        let (x, y) = (place as u32 % width, place as u32 / width);
        let cell = &mut cells[(y / GROUP) as usize * columns + (x / GROUP) as usize];
        *cell = Some(around(*cell, [x, y, x, y]));
    }
    let mut found = Vec::new();
    for start in 0..cells.len() {
        let Some(mut group) = cells[start].take() else { continue };
        let mut open = vec![start];
        while let Some(at) = open.pop() {
            let (column, row) = (at % columns, at / columns);
            for y in row.saturating_sub(1)..(row + 2).min(rows) {
                for x in column.saturating_sub(1)..(column + 2).min(columns) {
                    if let Some(cell) = cells[y * columns + x].take() {
                        group = around(Some(group), cell);
                        open.push(y * columns + x);
                    }
                }
            }
        }
        let [left, top, right, bottom] = group;
        found.push([
            left.saturating_sub(MARGIN),
            top.saturating_sub(MARGIN),
            (right + MARGIN).min(width - 1),
            (bottom + MARGIN).min(height - 1),
        ]);
    }
    found
}

fn around(first: Option<Box>, second: Box) -> Box {
    let Some(first) = first else { return second };
    [first[0].min(second[0]), first[1].min(second[1]), first[2].max(second[2]), first[3].max(second[3])]
}

fn outline(image: &mut RgbImage, [left, top, right, bottom]: Box) {
    for x in left..=right {
        image.put_pixel(x, top, MARK);
        image.put_pixel(x, bottom, MARK);
    }
    for y in top..=bottom {
        image.put_pixel(left, y, MARK);
        image.put_pixel(right, y, MARK);
    }
}

fn png(image: &RgbImage) -> Option<String> {
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive);
    let (width, height) = image.dimensions();
    encoder.write_image(image.as_raw(), width, height, image::ExtendedColorType::Rgb8).ok()?;
    Some(format!("data:image/png;base64,{}", BASE64_STANDARD.encode(bytes)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(uri: &str) -> RgbImage {
        let bytes = BASE64_STANDARD
            .decode(uri.strip_prefix("data:image/png;base64,").expect("a PNG"))
            .expect("base64");
        image::load_from_memory(&bytes).expect("a picture").into_rgb8()
    }

    #[test]
    fn one_missing_pixel_is_seen_in_a_smaller_picture() {
        let (width, height) = (1120, 630);
        let picture = Image { width, height, rgba: vec![200; (width * height * 4) as usize] };
        let mut missing = vec![false; (width * height) as usize];
        missing[(300 * width + 701) as usize] = true;
        let marked = decode(&marked_uri(&picture, &missing).expect("a picture"));
        assert_eq!(marked.dimensions(), (560, 315));
        assert_eq!(*marked.get_pixel(350, 150), MARK);
        // Its box.
        assert_eq!([*marked.get_pixel(345, 150), *marked.get_pixel(350, 155)], [MARK; 2]);
        assert_eq!(*marked.get_pixel(351, 151), Rgb([228; 3]));
        assert_eq!(*decode(&data_uri(&picture).expect("a picture")).get_pixel(3, 3), Rgb([200; 3]));
    }

    #[test]
    fn near_marks_share_a_box() {
        let mut marks = vec![false; 200 * 100];
        for (x, y) in [(10, 10), (20, 18), (150, 90), (199, 99)] {
            marks[y * 200 + x] = true;
        }
        assert_eq!(boxes(&marks, 200, 100), [[5, 5, 25, 23], [145, 85, 155, 95], [194, 94, 199, 99]]);
    }

    #[test]
    fn broken_pictures_are_left_out() {
        assert_eq!(data_uri(&Image::default()), None);
        assert_eq!(data_uri(&Image { width: 2, height: 2, rgba: vec![0; 3] }), None);
    }
}
