//! What is stored of all that was built: the pieces that save most triangles for their bytes.
//!
//! A piece stands in for originals with fewer triangles. Where it is good enough to be drawn it saves the difference, in
//! every place where it is used. So pieces are taken by the ratio of the triangles they replace to their own, times their
//! uses, which takes the coarse levels first and drops the finest first.

/// Something that can be stored or left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// Bytes it takes, JSON and tables counted.
    pub(super) bytes: u64,
    /// Triangles of the originals that it stands for, in all places together.
    pub(super) replaced: u64,
    /// Its own triangles.
    pub(super) triangles: u64,
}

/// Replacing fewer triangles than this many times its own is not worth a piece's bytes.
const LEAST_RATIO: f64 = 1.5;

impl Piece {
    fn score(&self) -> f64 {
        self.replaced as f64 / self.triangles.max(1) as f64
    }
}

/// Which pieces to keep within `limit` bytes.
pub(super) fn choose(pieces: &[Piece], limit: u64) -> Vec<bool> {
    let mut order: Vec<usize> = (0..pieces.len()).collect();
    order.sort_by(|&a, &b| pieces[b].score().total_cmp(&pieces[a].score()).then(a.cmp(&b)));
    let mut keep = vec![false; pieces.len()];
    let mut left = limit;
    for index in order {
        let piece = &pieces[index];
        if piece.triangles == 0 || piece.score() < LEAST_RATIO {
            continue;
        }
        // One that does not fit does not keep smaller ones from fitting.
        if let Some(rest) = left.checked_sub(piece.bytes) {
            left = rest;
            keep[index] = true;
        }
    }
    keep
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_and_much_used_first() {
        let piece = |bytes, replaced, triangles| Piece { bytes, replaced, triangles };
        let pieces = [piece(100, 1000, 100), piece(100, 8000, 100), piece(100, 900, 100), piece(10, 10, 9)];
        assert_eq!(choose(&pieces, 1000), [true, true, true, false], "the last one saves nothing");
        assert_eq!(choose(&pieces, 250), [true, true, false, false]);
        assert_eq!(choose(&pieces, 100), [false, true, false, false]);
        assert_eq!(choose(&pieces, 99), [false; 4]);
        assert_eq!(choose(&[piece(1, 10, 0)], 9), [false], "nothing to draw");
    }
}
