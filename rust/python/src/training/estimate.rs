//! Estimates with many seeds in one call, on several threads if Rust steps the environment.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use numpy::{PyReadonlyArray1, PyReadwriteArray3, PyUntypedArrayMethods};
use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;
use qtab_core::memory::{AllocationError, MemoryRoom};
use qtab_core::{Budget, StopFlag};

use super::{EnvironmentSpec, Memory, WORK_BETWEEN_CHECKS, room_of};
use crate::convert::Seeds;
use crate::error::{RunError, invalid};
use crate::interrupt::{on_threads, run_polled};
use crate::locks::{into_inner, lock};
use crate::runs::{Run, python_task};
use crate::spec::{Fields, PredictionSpec, RunSpec};

/// The number of episodes logged at once. Their returns are not used.
const EPISODES_AT_ONCE: u64 = 1 << 16;

/// The index of a run that failed, and why.
type FailedRun = (usize, PyErr);

/// Estimates values with one run for each seed on `threads` threads, and writes the weights after each of the ascending
/// numbers of `episodes` into `weights`, (seeds, episodes, weights). `report` is called at intervals with the number of
/// episodes that all runs have finished. Returns the runs that failed; the rest of their weights are left unchanged.
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
    let (calls_python, divergence) = (prediction.calls_python(), prediction.divergence());
    let run_spec = Arc::new(run_spec.predicting(prediction)?);
    let estimates = Estimates { episodes, finished: &finished, room: room_of(memory), divergence };
    let mut rows = weights.as_slice_mut()?.chunks_mut((expected[1] * expected[2]).max(1)).enumerate();
    let check = || Ok(py.check_signals().and_then(|()| report())?);
    let env = match EnvironmentSpec::parse(&fields.nested("env")?)? {
        EnvironmentSpec::Native(env) => env,
        EnvironmentSpec::Python(env) => {
            let [seed] = &seeds[..] else { return Err(invalid("seeds", "one, where Python steps", seeds.len())) };
            let run = python_task(py, env, &run_spec, seed)?.build(&StopFlag::new())?.run;
            return rows.next().map_or(Ok(()), |(_, row)| estimates.run(run, row, check)).map(|()| Vec::new());
        }
    };
    let factory = env.runs(&run_spec)?;
    let mut failed = Vec::new();
    if calls_python {
        // On this thread, which holds the GIL: acquiring it at each step would take much longer than the step.
        for (index, row) in rows {
            let run = factory.build(&seeds[index], &StopFlag::new());
            if let Err(error) = run.and_then(|built| estimates.run(built.run, row, check)) {
                let diverged = error.is_instance_of::<PyOverflowError>(py);
                failed.push((index, error));
                // An exception from Python code ends all runs.
                if !diverged {
                    break;
                }
            }
        }
        return Ok(failed);
    }
    let (rows, shared_failed) = (Mutex::new(rows), Mutex::new(failed));
    // Takes runs one after another, until none is left.
    let work = |stop: &StopFlag<'_>| {
        while !stop.is_set() {
            let Some((index, row)) = lock(&rows).next() else { return };
            let check = || if stop.is_set() { Err(RunError::Allocation(AllocationError::Stopped)) } else { Ok(()) };
            let run = factory.build(&seeds[index], stop);
            if let Err(error) = run.and_then(|built| estimates.run(built.run, row, check)) {
                lock(&shared_failed).push((index, error));
            }
        }
    };
    run_polled(py, |_| report(), |stop| on_threads(threads.min(seeds.len()), || work(stop)))?;
    failed = into_inner(shared_failed);
    failed.sort_by_key(|&(index, _)| index);
    Ok(failed)
}

/// The data that all runs of one call share.
struct Estimates<'a> {
    episodes: &'a [u64],
    finished: &'a AtomicU64,
    room: MemoryRoom,
    /// Why the values can diverge, and what helps.
    divergence: &'static str,
}

impl Estimates<'_> {
    /// Runs to each of the numbers of episodes, and writes the weights then. Adds the finished episodes to those of all
    /// runs.
    fn run(&self, mut run: Box<dyn Run>, row: &mut [f64], check: impl Fn() -> Result<(), RunError>) -> PyResult<()> {
        run.limit_memory(self.room.clone());
        let width = row.len() / self.episodes.len();
        let mut finished = 0;
        for (&point, weights) in self.episodes.iter().zip(row.chunks_mut(width.max(1))) {
            while finished < point {
                let goal = (point - finished).min(EPISODES_AT_ONCE);
                let mut counted = 0;
                while counted < goal {
                    let budget = Budget { episodes: goal as usize, work: WORK_BETWEEN_CHECKS };
                    run.advance(budget).map_err(|error| self.as_python(error, finished))?;
                    let count = run.episodes().returns.len() as u64;
                    self.finished.fetch_add(count - counted, Ordering::Relaxed);
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

    /// Converts the error of a run to a Python exception; `finished` episodes were finished before.
    fn as_python(&self, error: RunError, finished: u64) -> PyErr {
        match error {
            RunError::Diverged { episode, .. } => PyOverflowError::new_err(format!(
                "the values diverged in episode {} (counted from 0): {}",
                episode as u64 + finished,
                self.divergence
            )),
            error => error.into(),
        }
    }
}
