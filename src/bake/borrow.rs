//! Fewer distinct rows of levels: objects borrow the row of another that is visible at least as often.
//!
//! Rows of levels are most of what a bake stores, and equal rows are stored once. Raising levels can only draw too
//! much, never miss anything, so where bytes are short an object takes over a row that is at least its own in every
//! direction. The cheapest are taken first: few triangles, few directions added.

use super::sample::Levels;
use super::tree::Member;
use rayon::prelude::*;
use std::collections::HashMap;

/// A distinct row and those who have it.
struct Row {
    /// For each level from 1 on, a bit per direction: at least that level. 64 directions per word.
    planes: Vec<u64>,
    members: Vec<u32>,
    triangles: f64,
    sum: u32,
    highest: u8,
}

/// Reduces the number of distinct rows to `rows`, or as far as it goes for at most `share` more visible triangles,
/// counted over all directions and levels. Returns the number of distinct rows left.
pub(super) fn borrow_rows(levels: &mut Levels, members: &[Member], rows: usize, share: f64) -> usize {
    let mut distinct = distinct_rows(levels, members);
    let mut left = distinct.len();
    if left <= rows {
        return left;
    }
    // Candidates in order of their sums: the first row that covers another is the cheapest one that does.
    distinct.sort_by(|a, b| a.sum.cmp(&b.sum).then_with(|| a.planes.cmp(&b.planes)));
    let total: f64 = distinct.iter().map(|r| r.triangles * f64::from(r.sum)).sum();
    let mut offers: Vec<(f64, usize, usize)> = distinct
        .par_iter()
        .enumerate()
        .filter_map(|(index, row)| {
            let lender = index + 1 + distinct[index + 1..].iter().position(|other| other.covers(row))?;
            let added = f64::from(distinct[lender].sum - row.sum);
            Some((row.triangles * added, index, lender))
        })
        .collect();
    offers.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));

    let mut budget = total * share;
    // A lender keeps its own row, and a borrower lends nothing.
    let mut lends = vec![false; distinct.len()];
    let mut gone = vec![false; distinct.len()];
    for (cost, borrower, lender) in offers {
        if left <= rows || cost > budget {
            break;
        }
        if lends[borrower] || gone[lender] {
            continue;
        }
        budget -= cost;
        lends[lender] = true;
        gone[borrower] = true;
        left -= 1;
        let row = levels.row(distinct[lender].members[0]).to_vec();
        for &member in &distinct[borrower].members {
            levels.set_row(member, &row);
        }
    }
    left
}

impl Row {
    /// At least as high in every direction, and no higher than the other's highest level: a level never exceeds
    /// the number of ancestors, and importance is stored up to the highest one.
    fn covers(&self, other: &Self) -> bool {
        self.highest == other.highest && self.planes.iter().zip(&other.planes).all(|(a, b)| b & !a == 0)
    }
}

fn distinct_rows(levels: &Levels, members: &[Member]) -> Vec<Row> {
    let mut known: HashMap<&[u8], usize> = HashMap::new();
    let mut rows: Vec<Row> = Vec::new();
    for (index, member) in members.iter().enumerate() {
        let row = levels.row(index as u32);
        let place = *known.entry(row).or_insert_with(|| {
            rows.push(Row::new(row));
            rows.len() - 1
        });
        rows[place].members.push(index as u32);
        rows[place].triangles += f64::from(member.triangles);
    }
    rows
}

impl Row {
    fn new(row: &[u8]) -> Self {
        let highest = row.iter().copied().max().unwrap_or(0);
        let words = row.len().div_ceil(64);
        let mut planes = vec![0; words * usize::from(highest)];
        for (direction, &level) in row.iter().enumerate() {
            for plane in 0..usize::from(level) {
                planes[plane * words + direction / 64] |= 1 << (direction % 64);
            }
        }
        let sum = row.iter().map(|&level| u32::from(level)).sum();
        Self { planes, members: Vec::new(), triangles: 0.0, sum, highest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::sample::random::Random;
    use crate::bake::tree::Aabb;
    use std::collections::HashSet;

    fn scene(count: u32, directions: usize) -> (Levels, Vec<Member>) {
        let mut random = Random::new(5, u64::from(count));
        let mut levels = Levels::new(count as usize, directions);
        for member in 0..count {
            let row: Vec<u8> = (0..directions).map(|_| (random.next() % 5 / 2) as u8).collect();
            levels.set_row(member, &row);
        }
        let members = (0..count)
            .map(|m| Member { bounds: Aabb::EMPTY, triangles: 1 + m % 7, parts: m..m + 1 })
            .collect();
        (levels, members)
    }

    fn distinct(levels: &Levels, members: &[Member]) -> usize {
        (0..members.len() as u32).map(|m| levels.row(m)).collect::<HashSet<_>>().len()
    }

    #[test]
    fn levels_only_rise_and_never_above_the_highest() {
        for directions in [5, 70] {
            let (mut levels, members) = scene(300, directions);
            let before = levels.clone();
            let left = borrow_rows(&mut levels, &members, 40, 1.0);
            assert_eq!(left, distinct(&levels, &members));
            assert!(left < distinct(&before, &members) || directions == 70);
            for member in 0..300 {
                let (old, new) = (before.row(member), levels.row(member));
                assert!(old.iter().zip(new).all(|(a, b)| a <= b));
                assert_eq!(old.iter().max(), new.iter().max());
            }
        }
    }

    #[test]
    fn the_cost_stays_within_the_share() {
        let (mut levels, members) = scene(400, 6);
        let mass = |levels: &Levels| -> f64 {
            (0..400)
                .map(|m| {
                    let sum: u32 = levels.row(m).iter().map(|&l| u32::from(l)).sum();
                    f64::from(sum * members[m as usize].triangles)
                })
                .sum()
        };
        let before = mass(&levels);
        borrow_rows(&mut levels, &members, 1, 0.02);
        assert!(mass(&levels) <= before * 1.02 && mass(&levels) > before);
    }

    #[test]
    fn nothing_happens_when_rows_are_few() {
        let (mut levels, members) = scene(50, 8);
        let before = levels.clone();
        assert_eq!(borrow_rows(&mut levels, &members, 50, 1.0), distinct(&before, &members));
        assert_eq!(levels, before);
    }
}
