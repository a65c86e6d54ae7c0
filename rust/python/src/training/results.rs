//! Where the results of many runs are written: straight into `NumPy`'s arrays, a row for each run.

use numpy::{PyReadwriteArray1, PyReadwriteArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error::invalid;
use crate::runs::Run;

/// The arrays of `Results` in `qtab/_spec.py`. Of a run that failed, the episodes before the failure are written, and the
/// rest of its row is left as it was.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Results<'py> {
    returns: PyReadwriteArray2<'py, f64>,
    lengths: PyReadwriteArray2<'py, i64>,
    terminated: PyReadwriteArray2<'py, bool>,
    /// (runs, values), or (runs, 0) where the tables are not kept.
    tables: PyReadwriteArray2<'py, f64>,
    /// Whether a run is finished and its row complete.
    finished: PyReadwriteArray1<'py, bool>,
}

/// The rows of one run.
pub(super) struct Row<'a> {
    pub(super) index: usize,
    returns: &'a mut [f64],
    lengths: &'a mut [i64],
    terminated: &'a mut [bool],
    tables: &'a mut [f64],
    finished: &'a mut bool,
}

impl Row<'_> {
    /// How many episodes the run has.
    pub(super) fn episodes(&self) -> usize {
        self.returns.len()
    }

    /// Writes the finished episodes of a run.
    pub(super) fn write_episodes(&mut self, run: &dyn Run) {
        let episodes = run.episodes();
        let count = episodes.returns.len().min(self.returns.len());
        self.returns[..count].copy_from_slice(&episodes.returns[..count]);
        self.lengths[..count].copy_from_slice(&episodes.lengths[..count]);
        self.terminated[..count].copy_from_slice(&episodes.terminated[..count]);
    }

    /// Writes a finished run.
    pub(super) fn write(mut self, run: &dyn Run) -> PyResult<()> {
        self.write_episodes(run);
        if !self.tables.is_empty() {
            let tables = run.tables();
            let size: usize = tables.iter().map(|table| table.len()).sum();
            if size != self.tables.len() {
                return Err(invalid("results['tables']", format!("{size} values a run"), self.tables.len()));
            }
            let mut rest = self.tables;
            for table in tables {
                let (values, after) = rest.split_at_mut(table.len());
                values.copy_from_slice(table);
                rest = after;
            }
        }
        *self.finished = true;
        Ok(())
    }
}

impl Results<'_> {
    pub(super) fn rows(&mut self) -> PyResult<Vec<Row<'_>>> {
        let runs = self.finished.as_slice_mut()?;
        let mut returns = split("returns", &mut self.returns, runs.len())?.into_iter();
        let mut lengths = split("lengths", &mut self.lengths, runs.len())?.into_iter();
        let mut terminated = split("terminated", &mut self.terminated, runs.len())?.into_iter();
        let mut tables = split("tables", &mut self.tables, runs.len())?.into_iter();
        let rows = runs.iter_mut().enumerate().map_while(|(index, finished)| {
            let (returns, lengths) = (returns.next()?, lengths.next()?);
            let (terminated, tables) = (terminated.next()?, tables.next()?);
            Some(Row { index, returns, lengths, terminated, tables, finished })
        });
        Ok(rows.collect())
    }
}

/// The rows of an array.
fn split<'a, T: numpy::Element>(
    name: &str,
    array: &'a mut PyReadwriteArray2<'_, T>,
    rows: usize,
) -> PyResult<Vec<&'a mut [T]>> {
    let (count, width) = (array.shape()[0], array.shape()[1]);
    if count != rows {
        return Err(invalid(&format!("results['{name}']"), format!("an array of {rows} rows"), count));
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
