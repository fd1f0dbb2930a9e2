//! Packing rules shared by the baker and the decoder: level rows, importance codes, the fingerprint.
//!
//! All functions are pure and use only operations that IEEE 754 rounds correctly, so that every machine writes the
//! same bytes.

use std::collections::HashMap;

/// Bytes of one packed row: `ceil(directions * level_bits / 8)`.
pub fn row_stride(directions: usize, level_bits: u8) -> usize {
    (directions * usize::from(level_bits)).div_ceil(8)
}

/// Smallest of 1, 2, 4, 8 bits that holds `max_level`.
pub fn level_bits_for(max_level: u8) -> u8 {
    match max_level {
        0..=1 => 1,
        2..=3 => 2,
        4..=15 => 4,
        _ => 8,
    }
}

/// Packs the levels of one object, one per direction, into [`row_stride`] bytes: direction `j` at bit
/// `j * level_bits`, least significant bit first. Unused bits are 0.
///
/// With 2 bits the levels 1, 0, 3, 2, 1 become the bytes `0xB1 0x01`.
///
/// # Panics
/// If `level_bits` is not 1, 2, 4 or 8, or a level does not fit.
pub fn pack_levels(levels: &[u8], level_bits: u8) -> Vec<u8> {
    assert!(matches!(level_bits, 1 | 2 | 4 | 8), "level_bits must be 1, 2, 4 or 8");
    let mut row = vec![0; row_stride(levels.len(), level_bits)];
    for (direction, &level) in levels.iter().enumerate() {
        assert!(u32::from(level) < 1 << level_bits, "level {level} needs more than {level_bits} bits");
        let bit = direction * usize::from(level_bits);
        row[bit / 8] |= level << (bit % 8);
    }
    row
}

/// Level of `direction` in a packed row.
///
/// # Panics
/// If the row is too short for `direction`.
#[inline]
pub fn unpack_level(row: &[u8], level_bits: u8, direction: usize) -> u8 {
    let bit = direction * usize::from(level_bits);
    let mask = (0xFF_u16 >> (8 - level_bits)) as u8;
    row[bit / 8] >> (bit % 8) & mask
}

/// Packed rows, each distinct one once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Palette {
    /// Distinct rows in the order in which objects first use them, [`Self::stride`] bytes each.
    pub rows: Vec<u8>,
    /// Bytes per row.
    pub stride: usize,
    /// Row of each object; `None` if that would cost more than it saves: row `k` then belongs to object `k`.
    pub index: Option<Vec<u32>>,
}

/// Packs `levels` (object-major, `directions` per object) and shares equal rows.
///
/// # Panics
/// As [`pack_levels`]; if `directions` is 0 or `levels` is not a whole number of rows.
pub fn palette(levels: &[u8], directions: usize, level_bits: u8) -> Palette {
    assert!(levels.len().is_multiple_of(directions), "levels must hold `directions` entries per object");
    let stride = row_stride(directions, level_bits);
    let objects = levels.len() / directions;
    let mut all = Vec::with_capacity(objects * stride);
    for row in levels.chunks_exact(directions) {
        all.extend(pack_levels(row, level_bits));
    }
    let mut known: HashMap<&[u8], u32> = HashMap::new();
    let mut rows = Vec::new();
    let mut index = Vec::with_capacity(objects);
    for row in all.chunks_exact(stride) {
        let next = known.len() as u32;
        index.push(*known.entry(row).or_insert_with(|| {
            rows.extend_from_slice(row);
            next
        }));
    }
    if rows.len() + objects * index_bytes(known.len().saturating_sub(1) as u32) < all.len() {
        Palette { rows, stride, index: Some(index) }
    } else {
        Palette { rows: all, stride, index: None }
    }
}

/// Bytes of the smallest unsigned glTF component (1, 2 or 4) that holds `largest`.
pub fn index_bytes(largest: u32) -> usize {
    match largest {
        0..=0xFF => 1,
        0x100..=0xFFFF => 2,
        _ => 4,
    }
}

/// `2^(-k/8)` for `k` in 0..8.
const EIGHTHS: [f64; 8] = [
    1.0,
    0.917_004_043_204_671_2,
    0.840_896_415_253_714_6,
    0.771_105_412_703_970_4,
    std::f64::consts::FRAC_1_SQRT_2,
    0.648_419_777_325_504_8,
    0.594_603_557_501_360_5,
    0.545_253_866_332_628_8,
];

/// Share of the reference area that an importance code stands for: `2^(-code/8)`.
fn share(code: u8) -> f64 {
    // A power of two, exactly: code / 8 is at most 31.
    EIGHTHS[usize::from(code % 8)] / f64::from(1_u32 << (code / 8))
}

/// Area in m² that an importance code stands for: `importance_area * 2^(-code/8)`. Code 255 stands for that or less.
pub fn importance_area(code: u8, importance_area: f64) -> f64 {
    importance_area * share(code)
}

/// The highest code whose area is not below `area` (m²): estimates err upwards, by at most 9 %.
///
/// Areas beyond `importance_area`, and NaN, give code 0; zero and less give 255.
pub fn importance_code(area: f64, importance_area: f64) -> u8 {
    let (mut low, mut high) = (0_u8, 255_u8);
    while low < high {
        let middle = low + (high - low).div_ceil(2);
        if importance_area * share(middle) >= area {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    low
}

/// 64-bit FNV-1a over the little-endian `u32` order value and the little-endian `u32` triangle count of each tree
/// object, in ascending order of the order values (document order below the anchor).
pub fn fingerprint(objects: impl IntoIterator<Item = (u32, u32)>) -> u64 {
    let mut hash = 0xCBF2_9CE4_8422_2325_u64;
    for (order, triangles) in objects {
        for byte in order.to_le_bytes().into_iter().chain(triangles.to_le_bytes()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3);
        }
    }
    hash
}

/// Sixteen lower-case hexadecimal digits.
pub fn format_hash(hash: u64) -> String {
    format!("{hash:016x}")
}

/// Inverse of [`format_hash`]; `None` unless the text is sixteen hexadecimal digits.
pub fn parse_hash(text: &str) -> Option<u64> {
    let digits = text.len() == 16 && text.bytes().all(|b| b.is_ascii_hexdigit());
    if digits { u64::from_str_radix(text, 16).ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn worked_example_of_the_documentation() {
        assert_eq!(pack_levels(&[1, 0, 3, 2, 1], 2), [0xB1, 0x01]);
        assert_eq!(pack_levels(&[1, 0, 1], 1), [0b101]);
        assert_eq!(pack_levels(&[7, 9], 4), [0x97]);
        assert_eq!(pack_levels(&[255], 8), [255]);
    }

    #[test]
    fn codes_are_eighths_of_an_octave() {
        for (k, &value) in EIGHTHS.iter().enumerate() {
            assert!((value.powi(8) - 2f64.powi(-(k as i32))).abs() < 1e-15);
        }
        assert_eq!(importance_code(8.0, 8.0), 0);
        assert_eq!(importance_code(4.0, 8.0), 8);
        assert_eq!(importance_code(1.0, 8.0), 24);
        assert_eq!(importance_code(0.0, 8.0), 255);
        assert_eq!(importance_code(-1.0, 8.0), 255);
        assert_eq!(importance_code(9.0, 8.0), 0);
        assert_eq!(importance_code(f64::NAN, 8.0), 0);
        assert_eq!(importance_area(255, 0.0), 0.0);
    }

    #[test]
    fn fingerprint_is_fnv_1a() {
        assert_eq!(fingerprint([]), 0xCBF2_9CE4_8422_2325);
        // A zero byte changes nothing before the multiplication: eight of them are eight multiplications.
        let eight = (0..8).fold(0xCBF2_9CE4_8422_2325_u64, |h, _| h.wrapping_mul(0x100_0000_01B3));
        assert_eq!(fingerprint([(0, 0)]), eight);
        assert_ne!(fingerprint([(0, 1), (1, 2)]), fingerprint([(0, 2), (1, 1)]));
        assert_eq!(parse_hash(&format_hash(0x0123)), Some(0x0123));
        assert_eq!(parse_hash("+123456789abcdef"), None);
        assert_eq!(parse_hash("123"), None);
    }

    #[test]
    fn equal_rows_are_stored_once() {
        let levels = [[3_u8; 42], [0; 42], [3; 42]].concat().repeat(10);
        let shared = palette(&levels, 42, 2);
        assert_eq!(shared.stride, 11);
        assert_eq!(shared.rows.len(), 22);
        assert_eq!(shared.index.unwrap()[..3], [0, 1, 0]);
        assert_eq!(palette(&[], 42, 2), Palette { rows: vec![], stride: 11, index: None });
    }

    proptest! {
        #[test]
        fn levels_survive(levels in prop::collection::vec(any::<u8>(), 1..100), bits in 0_u32..4) {
            let bits = 1_u8 << bits;
            let levels: Vec<u8> = levels.iter().map(|l| (u16::from(*l) & ((1_u16 << bits) - 1)) as u8).collect();
            let row = pack_levels(&levels, bits);
            prop_assert_eq!(row.len(), row_stride(levels.len(), bits));
            for (j, &level) in levels.iter().enumerate() {
                prop_assert_eq!(unpack_level(&row, bits, j), level);
            }
        }

        #[test]
        fn palette_keeps_every_row(rows in prop::collection::vec(prop::collection::vec(0_u8..2, 20), 0..60)) {
            let palette = palette(&rows.concat(), 20, 1);
            for (k, row) in rows.iter().enumerate() {
                let at = palette.index.as_ref().map_or(k, |index| index[k] as usize) * palette.stride;
                for (j, &level) in row.iter().enumerate() {
                    prop_assert_eq!(unpack_level(&palette.rows[at..at + palette.stride], 1, j), level);
                }
            }
        }

        #[test]
        fn codes_err_upwards_by_at_most_a_step(area in 1e-9_f64..1.0, reference in 1e-3_f64..1e3) {
            let area = area * reference;
            let decoded = importance_area(importance_code(area, reference), reference);
            prop_assert!(decoded >= area);
            prop_assert!(decoded <= area * 1.0906 || importance_code(area, reference) == 255);
        }
    }
}
