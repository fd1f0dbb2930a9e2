//! Sorting of whole numbers.
//!
//! The standard library's sort is compiled anew for every type that is sorted, 3 kB of WebAssembly each time, so all numbers are
//! sorted as 64-bit ones.

/// Ascending.
pub(crate) fn sorted(keys: impl Iterator<Item = u64>) -> Vec<u64> {
    let mut keys: Vec<u64> = keys.collect();
    keys.sort_unstable();
    keys
}

/// The lowest number that appears twice.
pub(crate) fn repeated(keys: impl Iterator<Item = u32>) -> Option<u32> {
    // What was widened fits again.
    sorted(keys.map(u64::from)).windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0] as u32)
}

/// Adds to a short ascending list.
pub(crate) fn insert<T: Copy + PartialOrd>(list: &mut Vec<T>, item: T) {
    let place = list.iter().position(|other| *other > item).unwrap_or(list.len());
    list.insert(place, item);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_stay_ascending() {
        let mut list = Vec::new();
        [3, 1, 2, 3, 0].into_iter().for_each(|item| insert(&mut list, item));
        assert_eq!(list, [0, 1, 2, 3, 3]);
        assert_eq!(sorted([3, u64::MAX, 1].into_iter()), [1, 3, u64::MAX]);
        assert_eq!(repeated([5, 3, 5, 4, 3].into_iter()), Some(3));
        assert_eq!(repeated([5, u32::MAX, 0].into_iter()), None);
    }
}
