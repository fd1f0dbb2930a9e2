//! Progress that also keeps time.

use super::progress::Progress;
use super::report::StageSeconds;
use std::sync::Mutex;
use std::time::Instant;

/// Passes progress on and measures each stage.
pub(super) struct Clock<'a> {
    inner: &'a dyn Progress,
    started: Instant,
    stages: Mutex<Vec<(String, Instant)>>,
}

impl<'a> Clock<'a> {
    pub(super) fn new(inner: &'a dyn Progress) -> Self {
        Self { inner, started: Instant::now(), stages: Mutex::default() }
    }

    /// Seconds since the beginning.
    pub(super) fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Seconds by stage so far; stages of the same name add up.
    pub(super) fn stages(&self) -> Vec<StageSeconds> {
        let stages = self.stages.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let mut sums: Vec<StageSeconds> = Vec::new();
        for (index, (name, start)) in stages.iter().enumerate() {
            let end = stages.get(index + 1).map_or_else(Instant::now, |next| next.1);
            let seconds = (end - *start).as_secs_f64();
            match sums.iter_mut().find(|s| s.name == *name) {
                Some(sum) => sum.seconds += seconds,
                None => sums.push(StageSeconds { name: name.clone(), seconds }),
            }
        }
        sums
    }
}

impl Progress for Clock<'_> {
    fn stage(&self, name: &str, total: Option<u64>) {
        let mut stages = self.stages.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        stages.push((name.to_owned(), Instant::now()));
        self.inner.stage(name, total);
    }

    fn advance(&self, delta: u64) {
        self.inner.advance(delta);
    }
}
