//! Long calls release the interpreter's lock and listen for Ctrl-C.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use qtab_core::StopFlag;

/// How often signals are checked. Ctrl-C takes effect within this time plus the time between two looks at the flag.
const POLL: Duration = Duration::from_millis(10);

/// How long [`run_resumable`] works on the calling thread. While other Python threads are busy, each return to the
/// interpreter takes milliseconds, so long work does not stay there.
const ON_THIS_THREAD: Duration = Duration::from_millis(100);

/// Calls `work` until it is finished, as it says by its result. It must go on where it stopped, ask often whether to pause,
/// and return soon when it is told so.
///
/// Short work is done on this thread: it is over before another one has started, whose core's caches are empty, too.
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

/// Does the same work on so many threads, of which this one is the first. Threads may run out: those that there are then do
/// all of it.
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

/// Runs `work` on a thread of its own, while this thread handles signals and other Python threads run. `work` must look
/// at the flag at least every few milliseconds and return early when it is set; the signal's exception is then raised.
///
/// Where no thread can be started, this one does the work, and the flag asks for signals.
pub(crate) fn run_interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&StopFlag<'_>) -> T + Send) -> PyResult<T> {
    run_polled(py, |_| Ok(()), work)
}

/// The same, and whenever signals are handled `poll` is called as well; an error that it returns stops the work and is raised.
///
/// Where no thread can be started, it is not called.
pub(crate) fn run_polled<T: Send>(
    py: Python<'_>,
    mut poll: impl FnMut(Python<'_>) -> PyResult<()>,
    work: impl FnOnce(&StopFlag<'_>) -> T + Send,
) -> PyResult<T> {
    let (stop, done, caller) = (StopFlag::new(), AtomicBool::new(false), thread::current());
    // Where the thread can take it, and this one can take it back.
    let work = Mutex::new(Some(work));
    let take = || work.lock().unwrap_or_else(PoisonError::into_inner).take();
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

/// Runs `work` on this thread. The flag asks for signals whenever `work` looks at it.
pub(crate) fn run_polling<T>(work: impl FnOnce(&StopFlag<'_>) -> T) -> PyResult<T> {
    run_polling_when(|| true, work)
}

/// Runs `work` on this thread, while other Python threads run. The flag asks for signals at most once per [`POLL`], since it
/// must wait for those threads each time.
pub(crate) fn run_detached<T: Send>(py: Python<'_>, work: impl FnOnce(&StopFlag<'_>) -> T + Send) -> PyResult<T> {
    let asked = Mutex::new(Instant::now());
    let is_due = || {
        let mut asked = asked.lock().unwrap_or_else(PoisonError::into_inner);
        let is_due = asked.elapsed() >= POLL;
        if is_due {
            *asked = Instant::now();
        }
        is_due
    };
    py.detach(|| run_polling_when(is_due, work))
}

/// Runs `work` on this thread. When `work` looks at the flag and `is_due` returns true, the flag asks for signals.
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
            *raised.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
        }
        stopped
    };
    let result = work(&StopFlag::polling(&poll));
    match raised.into_inner().unwrap_or_else(PoisonError::into_inner) {
        None => Ok(result),
        Some(error) => Err(error),
    }
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
