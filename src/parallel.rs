//! Work on the items of a list, on all cores where there are threads.

/// `work` of each item, in the order of the items.
#[cfg(feature = "bake")]
pub(crate) fn map<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
    use rayon::prelude::*;
    items.par_iter().map(work).collect()
}

/// `work` of each item, in the order of the items.
#[cfg(not(feature = "bake"))]
pub(crate) fn map<T, R>(items: &[T], work: impl Fn(&T) -> R) -> Vec<R> {
    items.iter().map(work).collect()
}
