//! The one door for long calls of pure Rust: detached from the interpreter, open to signals.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

/// Ctrl-C is noticed within this time, and the time that `work` takes to look at its flag.
const POLL: Duration = Duration::from_millis(50);

/// Runs `work` on a thread of its own while other Python threads run and signals are handled here. `work` looks at the
/// flag every few thousand steps and returns early when it is set; the signal's exception is then raised.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce(&AtomicBool) -> T + Send) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    let done = AtomicBool::new(false);
    let caller = thread::current();
    thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let _knock = Knock { done: &done, caller };
            work(&stop)
        });
        let mut signal = Ok(());
        while !done.load(Ordering::Acquire) {
            py.detach(|| thread::park_timeout(POLL));
            if signal.is_ok() {
                signal = py.check_signals();
                stop.store(signal.is_err(), Ordering::Release);
            }
        }
        let result = py.detach(|| worker.join());
        signal.map(|()| result.unwrap_or_else(|panic| resume_unwind(panic)))
    })
}

/// Wakes the caller when it goes out of scope, after a panic too.
struct Knock<'a> {
    done: &'a AtomicBool,
    caller: thread::Thread,
}

impl Drop for Knock<'_> {
    fn drop(&mut self) {
        self.done.store(true, Ordering::Release);
        self.caller.unpark();
    }
}
