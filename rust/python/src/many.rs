//! Many runs in one call: threads of the call's own, in batches where that pays, the results straight into `NumPy`'s arrays.

use std::any::Any;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::vec::IntoIter;

use numpy::{PyReadwriteArray1, PyReadwriteArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::Budget;
use qtab_core::batch::{Article, Balance, BatchedRun, LANES};

use crate::dispatch::build;
use crate::door;
use crate::failure::Failure;
use crate::plan::Plan;
use crate::run::Run;
use crate::trainer::STEPS_BETWEEN_LOOKS;

/// What is worth a batch where there are fewer than `LANES`.
const HALF: usize = LANES / 2;

/// Where the results go: a row for each run, in the order of the runs. Of a run that failed, the episodes before are there,
/// and the rest of its row is as it was.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Results<'py> {
    returns: PyReadwriteArray2<'py, f64>,
    lengths: PyReadwriteArray2<'py, i64>,
    terminated: PyReadwriteArray2<'py, bool>,
    /// (runs, values), or (runs, 0) where the tables are not kept.
    tables: PyReadwriteArray2<'py, f64>,
    /// Whether a run is finished, and its row complete.
    finished: PyReadwriteArray1<'py, bool>,
}

/// One run's rows.
struct Row<'a> {
    index: usize,
    returns: &'a mut [f64],
    lengths: &'a mut [i64],
    terminated: &'a mut [bool],
    table: &'a mut [f64],
    finished: &'a mut bool,
}

impl Row<'_> {
    /// Takes in the episodes of a run; where one failed, those before.
    fn fill_episodes(&mut self, run: &dyn Run) {
        let episodes = run.episodes();
        let count = episodes.returns.len().min(self.returns.len());
        self.returns[..count].copy_from_slice(&episodes.returns[..count]);
        self.lengths[..count].copy_from_slice(&episodes.lengths[..count]);
        self.terminated[..count].copy_from_slice(&episodes.terminated[..count]);
    }

    /// Takes in a finished run.
    fn fill(mut self, run: &dyn Run) -> PyResult<()> {
        self.fill_episodes(run);
        if !self.table.is_empty() {
            let tables = run.tables();
            if tables.len() != self.table.len() {
                return Err(PyValueError::new_err(format!("the tables must have {} values", tables.len())));
            }
            self.table.copy_from_slice(tables.as_ref());
        }
        *self.finished = true;
        Ok(())
    }
}

/// A run that failed, and why.
type Failed = (usize, PyErr);

/// What the threads of one call share.
struct Work<'a> {
    describe: Py<PyAny>,
    rows: Mutex<IntoIter<Row<'a>>>,
    failed: Mutex<Vec<Failed>>,
    go_on: bool,
    over: AtomicBool,
}

/// Trains what `describe(index)` returns, an environment of Rust's and a plan for each row, on so many threads. Returns
/// the runs that failed; unless `go_on` is set, no run is begun after the first that did.
///
/// It is asked when a thread comes to a run, so that few tables more are alive than threads are at work.
#[pyfunction]
pub(crate) fn train_many(
    py: Python<'_>,
    describe: Py<PyAny>,
    mut results: Results<'_>,
    threads: usize,
    go_on: bool,
) -> PyResult<Vec<Failed>> {
    let rows = results.rows()?;
    let threads = threads.min(rows.len());
    // Few runs are shared out evenly first.
    let lanes = rows.len().div_ceil(threads.max(1)).min(LANES);
    let (rows, failed, over) = (Mutex::new(rows.into_iter()), Mutex::default(), AtomicBool::new(false));
    let work = Work { describe, rows, failed, go_on, over };
    door::detached(py, |stop| {
        thread::scope(|scope| {
            // This thread is one of them.
            (1..threads).for_each(|_| {
                scope.spawn(|| work.share(lanes, stop));
            });
            work.share(lanes, stop);
        });
    })?;
    let mut failed = work.failed.into_inner().unwrap_or_else(PoisonError::into_inner);
    failed.sort_by_key(|&(index, _)| index);
    Ok(failed)
}

impl<'a> Work<'a> {
    /// What one thread does: runs of the kinds that are batched together, every other one by itself.
    fn share(&self, lanes: usize, stop: &AtomicBool) {
        while let Some((row, run)) = self.next(stop) {
            let any: &dyn Any = &*run;
            if any.is::<Article>() {
                self.train_together::<Article>(row, run, lanes, stop);
            } else if any.is::<Balance>() {
                self.train_together::<Balance>(row, run, lanes, stop);
            } else {
                self.train(row, run, stop);
            }
        }
    }

    /// The next run that can be begun.
    fn next(&self, stop: &AtomicBool) -> Option<(Row<'a>, Box<dyn Run>)> {
        while !self.ends(stop) {
            let row = self.rows.lock().unwrap_or_else(PoisonError::into_inner).next()?;
            match self.begin(row.index) {
                Ok(run) => return Some((row, run)),
                Err(error) => self.fail(row.index, error),
            }
        }
        None
    }

    /// This run and those that follow, in batches of their kind; one of another kind is trained on the way.
    fn train_together<R: BatchedRun + Run>(&self, row: Row<'a>, run: Box<dyn Run>, lanes: usize, stop: &AtomicBool) {
        let mut first = Some((row, run));
        let (mut rows, mut runs) = (Vec::with_capacity(lanes), Vec::with_capacity(lanes));
        loop {
            while runs.len() < lanes
                && let Some((row, run)) = first.take().or_else(|| self.next(stop))
            {
                match unbox::<R>(run) {
                    Ok(run) => {
                        rows.push(row);
                        runs.push(run);
                    }
                    Err(other) => self.train(row, other, stop),
                }
            }
            if runs.is_empty() || self.ends(stop) {
                return;
            }
            let episodes = rows[0].returns.len();
            if let Err((lane, failure)) = advance(&mut runs, Budget { episodes, steps: STEPS_BETWEEN_LOOKS }) {
                let mut row = rows.swap_remove(lane);
                row.fill_episodes(&runs.swap_remove(lane));
                self.fail(row.index, failure.into());
            }
            for lane in (0..runs.len()).rev() {
                if runs[lane].episodes().returns.len() >= episodes {
                    self.finish(rows.swap_remove(lane), &runs.swap_remove(lane));
                }
            }
        }
    }

    fn begin(&self, index: usize) -> PyResult<Box<dyn Run>> {
        Python::attach(|py| {
            let answer = self.describe.bind(py).call1((index,))?;
            let (environment, plan): (Bound<'_, PyAny>, Plan<'_>) = answer.extract()?;
            build(&environment, &plan).map(|built| built.run)
        })
    }

    /// A run by itself.
    fn train(&self, mut row: Row<'a>, mut run: Box<dyn Run>, stop: &AtomicBool) {
        let episodes = row.returns.len();
        while run.episodes().returns.len() < episodes {
            if self.ends(stop) {
                return;
            }
            if let Err(failure) = run.advance(Budget { episodes, steps: STEPS_BETWEEN_LOOKS }) {
                row.fill_episodes(&*run);
                return self.fail(row.index, failure.into());
            }
        }
        self.finish(row, &*run);
    }

    fn finish(&self, row: Row<'a>, run: &dyn Run) {
        let index = row.index;
        if let Err(error) = row.fill(run) {
            self.fail(index, error);
        }
    }

    fn fail(&self, index: usize, error: PyErr) {
        self.failed.lock().unwrap_or_else(PoisonError::into_inner).push((index, error));
        self.over.fetch_or(!self.go_on, Ordering::AcqRel);
    }

    fn ends(&self, stop: &AtomicBool) -> bool {
        stop.load(Ordering::Acquire) || self.over.load(Ordering::Acquire)
    }
}

/// The run itself, where it is of that type.
fn unbox<R: Run>(run: Box<dyn Run>) -> Result<R, Box<dyn Run>> {
    if !(&*run as &dyn Any).is::<R>() {
        return Err(run);
    }
    let any: Box<dyn Any> = run;
    Ok(*any.downcast().expect("it is of that type"))
}

/// As many as go together at once; of few, one.
fn advance<R: BatchedRun + Run>(runs: &mut [R], until: Budget) -> Result<(), (usize, Failure)> {
    let result = if let Some(runs) = runs.first_chunk_mut::<LANES>() {
        R::advance_all(runs, until)
    } else if let Some(runs) = runs.first_chunk_mut::<HALF>() {
        R::advance_all(runs, until)
    } else if let Some(run) = runs.first_mut() {
        return Run::advance(run, until).map_err(|failure| (0, failure));
    } else {
        return Ok(());
    };
    result.map_err(|(lane, outside)| (lane, outside.into()))?;
    match runs.iter().enumerate().find_map(|(lane, run)| run.check().err().map(|failure| (lane, failure))) {
        Some(failed) => Err(failed),
        None => Ok(()),
    }
}

impl Results<'_> {
    fn rows(&mut self) -> PyResult<Vec<Row<'_>>> {
        let runs = self.finished.as_slice_mut()?;
        let mut returns = split(&mut self.returns, runs.len())?.into_iter();
        let mut lengths = split(&mut self.lengths, runs.len())?.into_iter();
        let mut terminated = split(&mut self.terminated, runs.len())?.into_iter();
        let mut tables = split(&mut self.tables, runs.len())?.into_iter();
        let rows = runs.iter_mut().enumerate().map_while(|(index, finished)| {
            let (returns, lengths) = (returns.next()?, lengths.next()?);
            let (terminated, table) = (terminated.next()?, tables.next()?);
            Some(Row { index, returns, lengths, terminated, table, finished })
        });
        Ok(rows.collect())
    }
}

/// The rows of an array.
fn split<'a, T: numpy::Element>(array: &'a mut PyReadwriteArray2<'_, T>, rows: usize) -> PyResult<Vec<&'a mut [T]>> {
    let (count, width) = (array.shape()[0], array.shape()[1]);
    if count != rows {
        return Err(PyValueError::new_err(format!("the results must hold {rows} rows, got {count}")));
    }
    let mut rest = array.as_slice_mut()?;
    let mut parts = Vec::with_capacity(rows);
    for _ in 0..rows {
        let (row, after) = rest.split_at_mut(width);
        parts.push(row);
        rest = after;
    }
    Ok(parts)
}
