//! Ctrl-C ends the program at once, except while a file is being written: that is finished first, so that neither
//! a half file nor a temporary one stays behind. A second Ctrl-C ends it even then.

use std::sync::Mutex;
use std::sync::PoisonError;

/// Exit code of a program ended by SIGINT, by the shells' convention 128 + signal.
const INTERRUPTED: i32 = 130;

#[derive(Debug, PartialEq, Eq)]
enum State {
    Idle,
    Writing,
    WritingInterrupted,
}

static STATE: Mutex<State> = Mutex::new(State::Idle);

/// Takes over SIGINT, SIGTERM and SIGHUP (Ctrl-C and Ctrl-Break on Windows). Without it, as when the system refuses, they end
/// the program in the middle of a write too.
pub(crate) fn install() {
    let _ = ctrlc::set_handler(|| {
        let mut state = STATE.lock().unwrap_or_else(PoisonError::into_inner);
        if *state == State::Writing {
            *state = State::WritingInterrupted;
        } else {
            std::process::exit(INTERRUPTED);
        }
    });
}

/// Runs a write that is not to be cut in two.
pub(crate) fn protect<T>(write: impl FnOnce() -> T) -> T {
    *STATE.lock().unwrap_or_else(PoisonError::into_inner) = State::Writing;
    let result = write();
    let mut state = STATE.lock().unwrap_or_else(PoisonError::into_inner);
    if *state == State::WritingInterrupted {
        std::process::exit(INTERRUPTED);
    }
    *state = State::Idle;
    result
}
