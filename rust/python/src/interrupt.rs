//! Long calls of pure Rust: detached from the interpreter, interruptible by signals. Every such call goes through here.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

/// How often signals are checked. Ctrl-C takes effect within this time plus the time between two checks of the flag.
const POLL: Duration = Duration::from_millis(50);

/// Runs `work` on a thread of its own, while this thread handles signals and other Python threads run. `work` must check
/// the flag every few thousand steps and return early when it is set; the signal's exception is then raised.
pub(crate) fn run_interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&AtomicBool) -> T + Send) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    let done = AtomicBool::new(false);
    let caller = thread::current();
    thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let _wake = WakeOnDrop { done: &done, caller };
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

/// Wakes the calling thread when it is dropped, also when `work` panics.
struct WakeOnDrop<'a> {
    done: &'a AtomicBool,
    caller: thread::Thread,
}

impl Drop for WakeOnDrop<'_> {
    fn drop(&mut self) {
        self.done.store(true, Ordering::Release);
        self.caller.unpark();
    }
}
