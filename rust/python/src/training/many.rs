//! Many runs in one call, on several threads, and in batches if the runs can be batched.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use pyo3::prelude::*;
use qtab_core::memory::MemoryRoom;
use qtab_core::{Budget, StopFlag};

use super::env_spec::EnvironmentSpec;
use super::results::{Results, Row, Rows};
use super::{Memory, WORK_BETWEEN_CHECKS, room_of};
use crate::convert::{Seed, Seeds};
use crate::interrupt::{on_threads, run_interruptible};
use crate::locks::{into_inner, lock};
use crate::runs::{RunBatch, RunFactory, check_tables};
use crate::spec::{Fields, InitialQSpec, RunSpec};

/// The index of a run that failed, and why.
type FailedRun = (usize, PyErr);

/// Trains one run for each seed, in an environment that Rust steps, on `threads` threads, and writes the runs into
/// `results`. Returns the runs that failed; unless `keep_going` is set, the first failure ends all runs.
///
/// The learners of all runs share `memory`. A run starts when a thread becomes free, so that few more tables exist than
/// threads are working.
#[pyfunction]
#[pyo3(signature = (spec, seeds, results, threads, keep_going, memory = None))]
pub(crate) fn train_many(
    py: Python<'_>,
    spec: &Bound<'_, PyAny>,
    seeds: Seeds,
    mut results: Results<'_>,
    threads: usize,
    keep_going: bool,
    memory: Option<Memory>,
) -> PyResult<Vec<FailedRun>> {
    let fields = Fields::new(spec)?;
    let env = EnvironmentSpec::native(&fields, "an environment that Rust steps")?;
    let run_spec = Arc::new(RunSpec::parse(&fields)?);
    let factory = env.runs(&run_spec)?;
    let Seeds(seeds) = seeds;
    let rows = results.rows(seeds.len())?;
    let threads = threads.min(seeds.len());
    // If there are few runs, divide them evenly among the threads.
    let share = seeds.len().div_ceil(threads.max(1));
    let queue = WorkQueue {
        factory: &*factory,
        initial_q: &run_spec.initial_q,
        seeds: &seeds,
        rows: Mutex::new(rows),
        failed: Mutex::default(),
        keep_going,
        room: room_of(memory),
        cancelled: AtomicBool::new(false),
    };
    run_interruptible(py, |stop| on_threads(threads, || queue.run_worker(share, stop)))?;
    let mut failed = into_inner(queue.failed);
    failed.sort_by_key(|&(index, _)| index);
    Ok(failed)
}

/// The data that the threads of one call share.
struct WorkQueue<'a> {
    factory: &'a dyn RunFactory,
    initial_q: &'a InitialQSpec,
    seeds: &'a [Seed],
    rows: Mutex<Rows<'a>>,
    failed: Mutex<Vec<FailedRun>>,
    keep_going: bool,
    room: MemoryRoom,
    cancelled: AtomicBool,
}

impl<'a> WorkQueue<'a> {
    /// The work of one thread: keeps a batch of up to `share` runs full until no run is left.
    fn run_worker(&self, share: usize, stop: &StopFlag<'_>) {
        let mut batch = self.factory.batch(&self.room);
        let mut rows = Vec::new();
        let lanes = batch.lanes().min(share);
        loop {
            self.fill(&mut *batch, &mut rows, lanes, stop);
            if rows.is_empty() || self.is_cancelled(stop) {
                return;
            }
            let episodes = rows[0].episodes();
            if let Err((index, error)) = batch.advance(Budget { episodes, work: WORK_BETWEEN_CHECKS }) {
                let mut row = rows.swap_remove(index);
                row.write_episodes(batch.run(index));
                batch.swap_remove(index);
                self.fail(row.index, error.into());
            }
            for index in (0..rows.len()).rev() {
                if batch.run(index).episodes().returns.len() >= episodes {
                    let mut row = rows.swap_remove(index);
                    let (number, run) = (row.index, batch.run(index));
                    row.write_episodes(run);
                    let checked = check_tables(run, self.initial_q).map_err(PyErr::from);
                    if let Err(error) = checked.and_then(|()| row.write_tables(run)) {
                        self.fail(number, error);
                    }
                    batch.swap_remove(index);
                }
            }
        }
    }

    /// Starts runs until the batch has `lanes` runs, or no run is left.
    fn fill(&self, batch: &mut dyn RunBatch, rows: &mut Vec<Row<'a>>, lanes: usize, stop: &StopFlag<'_>) {
        while rows.len() < lanes && !self.is_cancelled(stop) {
            let Some(row) = lock(&self.rows).next() else { return };
            match batch.push(&self.seeds[row.index], stop) {
                Ok(()) => rows.push(row),
                // An error from an interrupted construction is not a failed run.
                Err(_) if stop.is_set() => return,
                Err(error) => self.fail(row.index, error),
            }
        }
    }

    fn fail(&self, index: usize, error: PyErr) {
        lock(&self.failed).push((index, error));
        self.cancelled.fetch_or(!self.keep_going, Ordering::AcqRel);
    }

    fn is_cancelled(&self, stop: &StopFlag<'_>) -> bool {
        stop.is_set() || self.cancelled.load(Ordering::Acquire)
    }
}
