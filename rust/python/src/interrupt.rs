//! Long calls release the GIL and react to Ctrl-C.

use std::panic::resume_unwind;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use qtab_core::StopFlag;

use crate::locks::{into_inner, lock};

/// The interval between checks for signals. Ctrl-C takes effect within this time plus the time between two checks of
/// the flag.
const POLL: Duration = Duration::from_millis(10);

/// The time that [`run_resumable`] works on the calling thread. While other Python threads are busy, each return to the
/// interpreter takes milliseconds, so long work moves to another thread.
const ON_THIS_THREAD: Duration = Duration::from_millis(100);

/// Calls `work` until its result reports that it is finished. `work` must resume where it stopped, ask often whether to
/// pause, and return soon when told to.
///
/// Short work runs on this thread: it finishes before another thread, with empty caches, would have started.
pub(crate) fn run_resumable<E: Send>(
    py: Python<'_>,
    mut work: impl FnMut(&dyn Fn() -> bool) -> Result<bool, E> + Send,
) -> PyResult<Result<(), E>> {
    let started = Instant::now();
    while started.elapsed() < ON_THIS_THREAD {
        let detached = Instant::now();
        match py.detach(|| work(&|| detached.elapsed() >= POLL)) {
            Ok(false) => py.check_signals()?,
            finished => return Ok(finished.map(drop)),
        }
    }
    run_interruptible(py, |stop| work(&|| stop.is_set()).map(drop))
}

/// Does the same work on this many threads, including the calling one. If no more threads can be started, the existing
/// ones do all of it.
pub(crate) fn on_threads(threads: usize, work: impl Fn() + Sync) {
    thread::scope(|scope| {
        for _ in 1..threads {
            if thread::Builder::new().spawn_scoped(scope, &work).is_err() {
                break;
            }
        }
        work();
    });
}

/// Runs `work` on a new thread, while this thread handles signals and other Python threads run. `work` must check the
/// flag at least every few milliseconds and return early when it is set; the signal's exception is then raised.
///
/// If no thread can be started, `work` runs on this thread, and the flag checks for signals.
pub(crate) fn run_interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&StopFlag<'_>) -> T + Send) -> PyResult<T> {
    run_polled(py, |_| Ok(()), work)
}

/// Like [`run_interruptible`], but also calls `poll` whenever signals are handled; an error from `poll` stops the work
/// and is raised.
///
/// If no thread can be started, `poll` is not called.
pub(crate) fn run_polled<T: Send>(
    py: Python<'_>,
    mut poll: impl FnMut(Python<'_>) -> PyResult<()>,
    work: impl FnOnce(&StopFlag<'_>) -> T + Send,
) -> PyResult<T> {
    let (stop, done, caller) = (StopFlag::new(), AtomicBool::new(false), thread::current());
    // In a mutex, so that the thread can take it, and this thread can take it back.
    let work = Mutex::new(Some(work));
    let take = || lock(&work).take();
    let finished = thread::scope(|scope| {
        let worker = thread::Builder::new().spawn_scoped(scope, || {
            let _wake = WakeOnDrop { done: &done, caller };
            take().map(|work| work(&stop))
        });
        let Ok(worker) = worker else { return Ok(None) };
        let mut signal = Ok(());
        while !done.load(Ordering::Acquire) {
            py.detach(|| thread::park_timeout(POLL));
            if signal.is_ok() {
                signal = py.check_signals().and_then(|()| poll(py));
                if signal.is_err() {
                    stop.set();
                }
            }
        }
        let result = py.detach(|| worker.join());
        signal.map(|()| result.unwrap_or_else(|panic| resume_unwind(panic)))
    })?;
    match (finished, take()) {
        (Some(result), _) => Ok(result),
        (None, Some(work)) => run_detached(py, work),
        (None, None) => unreachable!("the work is either done or still to do"),
    }
}

/// Runs `work` on this thread. Whenever `work` checks the flag, the flag checks for signals.
pub(crate) fn run_polling<T>(work: impl FnOnce(&StopFlag<'_>) -> T) -> PyResult<T> {
    run_polling_when(|| true, work)
}

/// Runs `work` on this thread, while other Python threads run. The flag checks for signals at most once per [`POLL`],
/// since each check must wait for those threads.
pub(crate) fn run_detached<T: Send>(py: Python<'_>, work: impl FnOnce(&StopFlag<'_>) -> T + Send) -> PyResult<T> {
    let asked = Mutex::new(Instant::now());
    let is_due = || {
        let mut asked = lock(&asked);
        let is_due = asked.elapsed() >= POLL;
        if is_due {
            *asked = Instant::now();
        }
        is_due
    };
    py.detach(|| run_polling_when(is_due, work))
}

/// Runs `work` on this thread. When `work` checks the flag and `is_due` returns true, the flag checks for signals.
fn run_polling_when<T>(is_due: impl Fn() -> bool + Sync, work: impl FnOnce(&StopFlag<'_>) -> T) -> PyResult<T> {
    let raised = Mutex::new(None);
    let poll = || {
        if !is_due() {
            return false;
        }
        #[expect(
            clippy::redundant_closure_for_method_calls,
            reason = "the method is not general enough in its lifetime"
        )]
        let signal = Python::attach(|py| py.check_signals());
        let stopped = signal.is_err();
        if let Err(error) = signal {
            *lock(&raised) = Some(error);
        }
        stopped
    };
    let result = work(&StopFlag::polling(&poll));
    match into_inner(raised) {
        None => Ok(result),
        Some(error) => Err(error),
    }
}

/// Wakes the calling thread when dropped, even if `work` panics.
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
