//! Holes: where something should be and nothing is.

use svs_render::{ItemBuffer, NO_ITEM};

/// For each pixel: the reference shows an object there (nearest opaque or transparent one), and the picture nothing at all.
/// Buffers of another size than the reference's show nothing.
pub fn hole_mask(reference: &ItemBuffer, picture: &ItemBuffer) -> Vec<bool> {
    let shows = |items: &ItemBuffer, at: usize| {
        [&items.nearest, &items.transparent]
            .into_iter()
            .any(|layer| layer.get(at).is_some_and(|&item| item != NO_ITEM))
    };
    let same = (reference.width, reference.height) == (picture.width, picture.height);
    (0..reference.nearest.len()).map(|at| shows(reference, at) && !(same && shows(picture, at))).collect()
}

/// Pixels of the largest region of set pixels; pixels are neighbours if they share an edge. `width` is the length of a
/// row, at least 1.
pub fn largest_region(mask: &[bool], width: usize) -> usize {
    let width = width.max(1);
    let mut seen = vec![false; mask.len()];
    let (mut pending, mut largest) = (Vec::new(), 0);
    for start in 0..mask.len() {
        if !mask[start] || seen[start] {
            continue;
        }
        seen[start] = true;
        pending.push(start);
        let mut pixels = 0;
        while let Some(at) = pending.pop() {
            pixels += 1;
            let column = at % width;
            let neighbours = [
                (column > 0).then(|| at - 1),
                (column + 1 < width).then_some(at + 1),
                at.checked_sub(width),
                Some(at + width),
            ];
            for next in neighbours.into_iter().flatten().filter(|&next| next < mask.len()) {
                if mask[next] && !std::mem::replace(&mut seen[next], true) {
                    pending.push(next);
                }
            }
        }
        largest = largest.max(pixels);
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_meet_at_edges_not_at_corners_and_not_around_the_border() {
        let mask = |text: &str| text.bytes().map(|byte| byte == b'#').collect::<Vec<_>>();
        assert_eq!(largest_region(&mask("...."), 2), 0);
        assert_eq!(largest_region(&mask("#..#"), 2), 1);
        assert_eq!(largest_region(&mask("##.#"), 2), 3);
        // The end of one row is no neighbour of the begin of the next.
        assert_eq!(largest_region(&mask("...##..."), 4), 1);
        assert_eq!(largest_region(&mask("####.#.#.##."), 4), 8);
        assert_eq!(largest_region(&[], 0), 0);
    }

    #[test]
    fn a_hole_is_where_only_the_reference_shows_something() {
        let buffer = |nearest: [u32; 4], transparent: [u32; 4]| ItemBuffer {
            width: 4,
            height: 1,
            nearest: nearest.to_vec(),
            transparent: transparent.to_vec(),
        };
        let reference = buffer([1, 2, NO_ITEM, NO_ITEM], [NO_ITEM, NO_ITEM, 3, NO_ITEM]);
        let picture = buffer([9, NO_ITEM, NO_ITEM, 9], [NO_ITEM, NO_ITEM, NO_ITEM, NO_ITEM]);
        assert_eq!(hole_mask(&reference, &picture), [false, true, true, false]);
        assert_eq!(hole_mask(&reference, &reference), [false; 4]);
        assert_eq!(hole_mask(&reference, &ItemBuffer::default()), [true, true, true, false]);
    }
}
