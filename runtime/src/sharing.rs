//! Trees may share tables, but a small file must not ask for unbounded memory and work by naming one large table
//! again and again.

use crate::decode::AccessorView;
use crate::sorting::sorted;

/// All tables together, counted as often as they are named, may be this many times as large as the memory they are in.
const MOST_SHARING: u64 = 16;

/// Bytes of tables, counted as often as they are named, that are accepted in any file.
const ALWAYS_ACCEPTED: u64 = 1 << 20;

/// The first of `tables` that is one too many, or `None`: a decoder keeps a copy of each table it is given (about 30
/// bytes for a byte at most), so what is decoded is bounded by a constant times what the file holds.
///
/// Bytes that several accessors view count once as memory, and as often as they are viewed as work: the sum may be 16
/// times the memory, or 1 MiB.
pub fn first_excess<'a>(tables: impl IntoIterator<Item = AccessorView<'a>>) -> Option<usize> {
    let views: Vec<(usize, usize)> =
        tables.into_iter().map(|view| (view.bytes.as_ptr().addr(), view.bytes.len())).collect();
    let limit = union(&views).saturating_mul(MOST_SHARING).max(ALWAYS_ACCEPTED);
    let mut total = 0_u64;
    views.iter().position(|&(_, length)| {
        total = total.saturating_add(length as u64);
        total > limit
    })
}

/// Bytes that are in at least one of the views.
fn union(views: &[(usize, usize)]) -> u64 {
    // Slices end inside the address space.
    let starts = sorted(views.iter().map(|&(start, _)| start as u64));
    let ends = sorted(views.iter().map(|&(start, length)| start.saturating_add(length) as u64));
    // The k-th end is not before the k-th start: where the next view starts after it, nothing is open.
    let mut bytes = 0;
    let mut begun = starts.first().copied().unwrap_or(0);
    for (place, &end) in ends.iter().enumerate() {
        match starts.get(place + 1) {
            Some(&next) if next <= end => {}
            next => {
                bytes += end - begun;
                begun = next.copied().unwrap_or(end);
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(bytes: &[u8]) -> AccessorView<'_> {
        AccessorView { bytes, component_type: 5121, components: 1, count: bytes.len() }
    }

    #[test]
    fn overlapping_views_are_one_memory() {
        assert_eq!(union(&[(10, 5), (12, 1), (14, 3), (100, 0), (20, 2), (10, 5)]), 9);
        assert_eq!(union(&[]), 0);
    }

    #[test]
    fn sharing_is_allowed_up_to_the_limit() {
        let large = vec![0; 1 << 20];
        assert_eq!(first_excess(std::iter::repeat_n(view(&large), 16)), None);
        assert_eq!(first_excess(std::iter::repeat_n(view(&large), 17)), Some(16));
        // Views that begin elsewhere in the same bytes are the same memory.
        assert_eq!(first_excess((0..40).map(|k| view(&large[k..]))), Some(16));
        let other = vec![0; 1 << 20];
        assert_eq!(first_excess(std::iter::repeat_n(view(&large), 31).chain([view(&other)])), None);
        let small = [0; 1024];
        assert_eq!(first_excess(std::iter::repeat_n(view(&small), 1024)), None);
        assert_eq!(first_excess(std::iter::repeat_n(view(&small), 2000)), Some(1024));
    }
}
