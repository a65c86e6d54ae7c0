//! Estimates with many seeds in one call, on threads of the call's own where Rust steps the environment.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use numpy::{PyReadonlyArray1, PyReadwriteArray3, PyUntypedArrayMethods};
use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;
use qtab_core::memory::MemoryRoom;
use qtab_core::{Budget, StopFlag};

use super::{EnvironmentSpec, Memory, WORK_BETWEEN_CHECKS, room_of};
use crate::convert::{Seed, Seeds};
use crate::error::{RunError, invalid};
use crate::interrupt::{on_threads, run_polled};
use crate::runs::{Run, RunFactory, python_task};
use crate::spec::{Fields, PredictionSpec, RunSpec};

/// How many episodes are logged at once. Their returns are of no further use.
const EPISODES_AT_ONCE: u64 = 1 << 16;

/// The index of a run that failed, and why.
type FailedRun = (usize, PyErr);

/// A run, and the part of the results that is its own: a row of weights for each recorded episode.
type Rows<'a> = std::iter::Enumerate<std::slice::ChunksMut<'a, f64>>;

/// Estimates values with one run for each seed on `threads` threads, and writes the weights after each of the ascending
/// numbers of `episodes` into `weights`, (seeds, episodes, weights). `report` is called now and then with the number of
/// episodes that all runs have finished. Returns the runs that failed; what they had not reached is left as it was.
#[pyfunction]
#[pyo3(signature = (spec, prediction, seeds, episodes, weights, threads, report, memory = None))]
#[expect(clippy::too_many_arguments, reason = "they are Python's")]
pub(crate) fn estimate_values(
    py: Python<'_>,
    spec: &Bound<'_, PyAny>,
    prediction: &Bound<'_, PyAny>,
    seeds: Seeds,
    episodes: PyReadonlyArray1<'_, u64>,
    mut weights: PyReadwriteArray3<'_, f64>,
    threads: usize,
    report: Option<Bound<'_, PyAny>>,
    memory: Option<Memory>,
) -> PyResult<Vec<FailedRun>> {
    let finished = AtomicU64::new(0);
    let report = || match &report {
        Some(report) => report.call1((finished.load(Ordering::Relaxed),)).map(|_| ()),
        None => Ok(()),
    };
    let fields = Fields::new(spec)?;
    let run_spec = RunSpec::parse(&fields)?;
    let prediction = PredictionSpec::parse(&Fields::new(prediction)?, run_spec.num_actions)?;
    let (Seeds(seeds), episodes) = (seeds, episodes.as_slice()?);
    let expected = [seeds.len(), episodes.len(), prediction.n_weights()];
    if weights.shape() != expected || episodes.is_empty() {
        let got = format!("{:?}", weights.shape());
        return Err(invalid("weights", format!("an array of shape {expected:?}, none of them 0"), got));
    }
    let (size, room) = (expected[1] * expected[2], room_of(memory));
    let calls_python = prediction.calls_python();
    let run_spec = Arc::new(run_spec.predicting(prediction)?);
    let mut rows = weights.as_slice_mut()?.chunks_mut(size.max(1)).enumerate();
    match EnvironmentSpec::parse(&fields.nested("env")?)? {
        EnvironmentSpec::Native(env) => {
            let factory = env.runs(&run_spec)?;
            let shared = Shared { factory: &*factory, seeds: &seeds, episodes, finished: &finished, room };
            if calls_python {
                let check = || py.check_signals().and_then(|()| report());
                return Ok(run_attached(py, &shared, rows, check));
            }
            let work = PredictionQueue { shared, rows: Mutex::new(rows), failed: Mutex::default() };
            let threads = threads.min(seeds.len());
            run_polled(py, |_| report(), |stop| on_threads(threads, || work.run_worker(stop)))?;
            let mut failed = work.failed.into_inner().unwrap_or_else(PoisonError::into_inner);
            failed.sort_by_key(|&(index, _)| index);
            Ok(failed)
        }
        EnvironmentSpec::Python(env) => {
            let [seed] = &seeds[..] else { return Err(invalid("seeds", "one, where Python steps", seeds.len())) };
            let mut run = python_task(py, env, &run_spec, seed)?.build(&StopFlag::new())?.run;
            run.limit_memory(room);
            let Some((_, row)) = rows.next() else { return Ok(Vec::new()) };
            let check = || Ok(py.check_signals().and_then(|()| report())?);
            advance(&mut *run, episodes, row, &finished, check).map_err(as_python)?;
            Ok(Vec::new())
        }
    }
}

/// Does one run after the other on this thread, which holds the interpreter's lock: to take it at each step would take much
/// longer than the step. Returns the runs that failed; an exception of Python code ends them all.
fn run_attached(
    py: Python<'_>,
    shared: &Shared<'_>,
    rows: Rows<'_>,
    check: impl Fn() -> PyResult<()>,
) -> Vec<FailedRun> {
    let mut failed = Vec::new();
    for (index, row) in rows {
        let done = shared.run(index, row, &StopFlag::new(), || Ok(check()?));
        if let Err(error) = done {
            let diverged = error.is_instance_of::<PyOverflowError>(py);
            failed.push((index, error));
            if !diverged {
                break;
            }
        }
    }
    failed
}

/// What all runs of one call share.
struct Shared<'a> {
    factory: &'a dyn RunFactory,
    seeds: &'a [Seed],
    episodes: &'a [u64],
    finished: &'a AtomicU64,
    room: MemoryRoom,
}

impl Shared<'_> {
    /// Does a run and writes its row.
    fn run(
        &self,
        index: usize,
        row: &mut [f64],
        stop: &StopFlag<'_>,
        check: impl Fn() -> Result<(), RunError>,
    ) -> PyResult<()> {
        let mut run = self.factory.build(&self.seeds[index], stop)?.run;
        run.limit_memory(self.room.clone());
        advance(&mut *run, self.episodes, row, self.finished, check).map_err(as_python)
    }
}

/// What the threads of one call share.
struct PredictionQueue<'a> {
    shared: Shared<'a>,
    rows: Mutex<Rows<'a>>,
    failed: Mutex<Vec<FailedRun>>,
}

impl PredictionQueue<'_> {
    /// What one thread does: one run after the other, until none is left.
    fn run_worker(&self, stop: &StopFlag<'_>) {
        while !stop.is_set() {
            let Some((index, row)) = self.rows.lock().unwrap_or_else(PoisonError::into_inner).next() else { return };
            let check = || if stop.is_set() { Err(RunError::Allocation(STOPPED)) } else { Ok(()) };
            if let Err(error) = self.shared.run(index, row, stop, check) {
                self.failed.lock().unwrap_or_else(PoisonError::into_inner).push((index, error));
            }
        }
    }
}

const STOPPED: qtab_core::memory::AllocationError = qtab_core::memory::AllocationError::Stopped;

/// Runs to each of these numbers of episodes, and writes the weights then. Adds the finished episodes to `all_finished`.
fn advance(
    run: &mut dyn Run,
    episodes: &[u64],
    row: &mut [f64],
    all_finished: &AtomicU64,
    check: impl Fn() -> Result<(), RunError>,
) -> Result<(), RunError> {
    let width = row.len() / episodes.len();
    let mut finished = 0;
    for (&point, weights) in episodes.iter().zip(row.chunks_mut(width.max(1))) {
        while finished < point {
            let goal = (point - finished).min(EPISODES_AT_ONCE);
            let mut counted = 0;
            while counted < goal {
                let budget = Budget { episodes: goal as usize, work: WORK_BETWEEN_CHECKS };
                run.advance(budget).map_err(|error| match error {
                    RunError::Diverged { episode } => RunError::Diverged { episode: episode + finished as usize },
                    error => error,
                })?;
                let count = run.episodes().returns.len() as u64;
                all_finished.fetch_add(count - counted, Ordering::Relaxed);
                counted = count;
                check()?;
            }
            run.take_episodes();
            finished += goal;
        }
        weights.copy_from_slice(run.tables()[0]);
    }
    Ok(())
}

/// The error as Python raises it.
fn as_python(error: RunError) -> PyErr {
    match error {
        RunError::Diverged { episode } => PyOverflowError::new_err(format!(
            "the values diverged in episode {episode} (counted from 0): the updates grow instead of settling; a smaller \
             learning_rate, trace_decay or discount helps"
        )),
        error => error.into(),
    }
}
