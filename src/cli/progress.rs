//! Progress bars on standard error: only on a terminal, never in a pipe.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::Duration;
use svs::bake::Progress;

/// One bar at a time: the stage at work, with the time left where its end is known.
#[derive(Debug)]
pub(crate) struct Bars {
    shown: bool,
    current: Mutex<ProgressBar>,
}

impl Bars {
    /// Bars if standard error is a terminal and the user has not asked for quiet.
    pub(crate) fn new(quiet: bool) -> Self {
        let shown = !quiet && std::io::stderr().is_terminal();
        Self { shown, current: Mutex::new(ProgressBar::hidden()) }
    }

    /// Removes the bar: what is printed next starts on a clean line.
    pub(crate) fn clear(&self) {
        self.replace(ProgressBar::hidden());
    }

    fn replace(&self, bar: ProgressBar) {
        // A panic in another thread must not become a second one here.
        let mut current = self.current.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        current.finish_and_clear();
        *current = bar;
    }
}

impl Progress for Bars {
    fn stage(&self, name: &str, total: Option<u64>) {
        if !self.shown {
            return;
        }
        let (length, template) = match total {
            Some(total) => (Some(total), "{msg:27} [{wide_bar}] {percent:>3} %  {eta_precise} left"),
            None => (None, "{msg:27} {spinner} {elapsed_precise}"),
        };
        let bar = ProgressBar::with_draw_target(length, ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(name.to_owned());
        // Redraws while a stage is busy between two steps, so that the clock goes on.
        bar.enable_steady_tick(Duration::from_millis(200));
        self.replace(bar);
    }

    fn advance(&self, delta: u64) {
        if self.shown {
            self.current.lock().unwrap_or_else(std::sync::PoisonError::into_inner).inc(delta);
        }
    }
}

impl Drop for Bars {
    fn drop(&mut self) {
        self.clear();
    }
}
