//! How a long bake tells what it is doing.

/// Receives progress. Calls come from several threads.
pub trait Progress: Sync {
    /// A stage begins; `total` is its work in units of its own, if known.
    fn stage(&self, name: &str, total: Option<u64>);
    /// `delta` more units of the current stage are done.
    fn advance(&self, delta: u64);
}

/// Says nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn stage(&self, _: &str, _: Option<u64>) {}
    fn advance(&self, _: u64) {}
}
