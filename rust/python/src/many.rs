//! Many runs in one call: threads of the call's own, each run by itself, its results straight into `NumPy`'s arrays.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use numpy::{PyReadwriteArray1, PyReadwriteArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::Until;

use crate::dispatch::build;
use crate::door;
use crate::plan::Plan;
use crate::trainer::STEPS_BETWEEN_LOOKS;

/// Where the results go: a row for each run, in the order of the runs.
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

/// A run that ended early, and why.
type Failed = (usize, PyErr);

/// Trains what `describe(index)` describes, a trainer for each row, on so many threads. Returns the runs that failed; unless
/// `go_on` is set, no run is begun after the first that did.
///
/// Trainers are made when a thread comes to them, so that no more of their tables are alive than threads are at work.
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
    let rows = Mutex::new(rows.into_iter());
    let failed = Mutex::new(Vec::new());
    door::detached(py, |stop| {
        let left = AtomicBool::new(false);
        let work = || {
            while !stop.load(Ordering::Acquire) && !left.load(Ordering::Acquire) {
                let Some(row) = rows.lock().unwrap_or_else(PoisonError::into_inner).next() else { return };
                let index = row.index;
                if let Err(error) = train_one(&describe, row, stop) {
                    failed.lock().unwrap_or_else(PoisonError::into_inner).push((index, error));
                    left.fetch_or(!go_on, Ordering::AcqRel);
                }
            }
        };
        thread::scope(|scope| {
            // This thread is one of them.
            (1..threads).for_each(|_| {
                scope.spawn(work);
            });
            work();
        });
    })?;
    let mut failed = failed.into_inner().unwrap_or_else(PoisonError::into_inner);
    failed.sort_by_key(|&(index, _)| index);
    Ok(failed)
}

fn train_one(describe: &Py<PyAny>, row: Row<'_>, stop: &AtomicBool) -> PyResult<()> {
    let mut run = Python::attach(|py| {
        let (environment, plan): (Bound<'_, PyAny>, Plan<'_>) = describe.bind(py).call1((row.index,))?.extract()?;
        build(&environment, &plan).map(|built| built.run)
    })?;
    let until = Until { episodes: row.returns.len(), steps: STEPS_BETWEEN_LOOKS };
    while run.episodes().returns.len() < until.episodes {
        if stop.load(Ordering::Acquire) {
            return Ok(());
        }
        run.advance(until).map_err(PyErr::from)?;
    }
    let episodes = run.episodes();
    row.returns.copy_from_slice(&episodes.returns);
    row.lengths.copy_from_slice(&episodes.lengths);
    row.terminated.copy_from_slice(&episodes.terminated);
    if !row.table.is_empty() {
        let tables = run.tables();
        if tables.len() != row.table.len() {
            return Err(PyValueError::new_err(format!("the tables must have {} values", tables.len())));
        }
        row.table.copy_from_slice(tables.as_ref());
    }
    *row.finished = true;
    Ok(())
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
