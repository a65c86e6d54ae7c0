//! The results of many runs, written directly into `NumPy` arrays, one row per run.

use std::mem::take;

use numpy::{PyReadwriteArray1, PyReadwriteArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error::invalid;
use crate::runs::Run;

/// The arrays of `Results` in `qtab/_spec.py`. If a run fails, the episodes before the failure are written, and the
/// rest of its row is left unchanged.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Results<'py> {
    returns: PyReadwriteArray2<'py, f64>,
    lengths: PyReadwriteArray2<'py, i64>,
    terminated: PyReadwriteArray2<'py, bool>,
    /// (runs, values), or (runs, 0) if the tables are not kept.
    tables: PyReadwriteArray2<'py, f64>,
    /// Whether a run is finished and its row complete.
    finished: PyReadwriteArray1<'py, bool>,
    /// The last action masks, (runs, values), or (runs, 0) if they are not kept.
    masks: PyReadwriteArray2<'py, bool>,
}

/// The rows of one run.
pub(super) struct Row<'a> {
    pub(super) index: usize,
    returns: &'a mut [f64],
    lengths: &'a mut [i64],
    terminated: &'a mut [bool],
    tables: &'a mut [f64],
    finished: &'a mut bool,
    masks: &'a mut [bool],
}

impl Row<'_> {
    /// The number of episodes of the run.
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

    /// Writes the tables and the action masks of a run whose episodes have all been written, which completes the row.
    pub(super) fn write_tables(self, run: &dyn Run) -> PyResult<()> {
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
        if !self.masks.is_empty() {
            match run.action_masks() {
                Some(masks) if masks.len() == self.masks.len() => self.masks.copy_from_slice(masks),
                masks => {
                    let expected = format!("{} values a run", masks.map_or(0, <[bool]>::len));
                    return Err(invalid("results['masks']", expected, self.masks.len()));
                }
            }
        }
        *self.finished = true;
        Ok(())
    }
}

/// The remaining rows, in order. They are not kept in a list, as there may be millions.
pub(super) struct Rows<'a> {
    next: usize,
    /// The numbers of columns: episodes, values of the tables, and values of the masks.
    widths: [usize; 3],
    returns: &'a mut [f64],
    lengths: &'a mut [i64],
    terminated: &'a mut [bool],
    tables: &'a mut [f64],
    finished: &'a mut [bool],
    masks: &'a mut [bool],
}

impl<'a> Iterator for Rows<'a> {
    type Item = Row<'a>;

    fn next(&mut self) -> Option<Row<'a>> {
        let [episodes, values, available] = self.widths;
        let (finished, rest) = take(&mut self.finished).split_first_mut()?;
        self.finished = rest;
        let (returns, rest) = take(&mut self.returns).split_at_mut(episodes);
        self.returns = rest;
        let (lengths, rest) = take(&mut self.lengths).split_at_mut(episodes);
        self.lengths = rest;
        let (terminated, rest) = take(&mut self.terminated).split_at_mut(episodes);
        self.terminated = rest;
        let (tables, rest) = take(&mut self.tables).split_at_mut(values);
        self.tables = rest;
        let (masks, rest) = take(&mut self.masks).split_at_mut(available);
        self.masks = rest;
        let index = self.next;
        self.next += 1;
        Some(Row { index, returns, lengths, terminated, tables, finished, masks })
    }
}

impl Results<'_> {
    /// The rows, one for each of `runs` runs.
    pub(super) fn rows(&mut self, runs: usize) -> PyResult<Rows<'_>> {
        let (episodes, values, available) = (self.returns.shape()[1], self.tables.shape()[1], self.masks.shape()[1]);
        let finished = self.finished.as_slice_mut()?;
        if finished.len() != runs {
            return Err(invalid(
                "results['finished']",
                format!("an array of {runs}, one for each seed"),
                finished.len(),
            ));
        }
        Ok(Rows {
            next: 0,
            widths: [episodes, values, available],
            returns: all("returns", &mut self.returns, [runs, episodes])?,
            lengths: all("lengths", &mut self.lengths, [runs, episodes])?,
            terminated: all("terminated", &mut self.terminated, [runs, episodes])?,
            tables: all("tables", &mut self.tables, [runs, values])?,
            finished,
            masks: all("masks", &mut self.masks, [runs, available])?,
        })
    }
}

/// The values of an array, whose shape is checked.
fn all<'a, T: numpy::Element>(
    name: &str,
    array: &'a mut PyReadwriteArray2<'_, T>,
    shape: [usize; 2],
) -> PyResult<&'a mut [T]> {
    if array.shape() != shape {
        let got = format!("{:?}", array.shape());
        return Err(invalid(&format!("results['{name}']"), format!("an array of shape {shape:?}"), got));
    }
    Ok(array.as_slice_mut()?)
}
