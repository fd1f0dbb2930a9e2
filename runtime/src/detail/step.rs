//! What a cut within a budget is made of: things to draw or drop, and refinements that may be made.

use std::cmp::Ordering;

/// Something that may be refined or dropped: a proxy of an entry, or a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Target {
    Proxy(u32),
    Slot(u32),
}

/// A thing in its coarsest form, to be drawn or dropped.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) entry: u32,
    pub(crate) target: Target,
}

/// A refinement that may be made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// Benefit per triangle or millisecond that it adds; infinite if it adds none.
    pub(crate) worth: f64,
    /// What it adds.
    pub(crate) triangles: i64,
    pub(crate) draws: i64,
    pub(crate) entry: u32,
    pub(crate) target: Target,
    /// Of a slot: the level it is refined to.
    pub(crate) level: u8,
}

impl PartialEq for Step {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Step {}

impl PartialOrd for Step {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Step {
    /// The greatest comes first: the worthiest, and of equal ones what is drawn first.
    fn cmp(&self, other: &Self) -> Ordering {
        self.worth.total_cmp(&other.worth).then((other.entry, other.target).cmp(&(self.entry, self.target)))
    }
}
