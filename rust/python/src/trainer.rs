//! A run that Python can go on with: `Trainer.advance` is the only long call there is.

use std::collections::VecDeque;
use std::sync::atomic::Ordering;
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use numpy::PyArray1;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use qtab_core::Budget;
use qtab_core::tasks::{Recording, Recordings};

use crate::dispatch::build;
use crate::door;
use crate::learning::{Built, Kept};
use crate::plan::Plan;

/// Signals are looked for after this many steps of Rust: a fraction of a millisecond.
pub(crate) const STEPS_BETWEEN_LOOKS: u64 = 8192;
/// The same for steps in Python, which may take a millisecond each.
const PYTHON_STEPS_BETWEEN_LOOKS: u64 = 64;

type Finished<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<bool>>);

/// A training run of any kind.
#[pyclass(frozen, module = "qtab._core")]
pub(crate) struct Trainer(Mutex<Built>);

#[pymethods]
impl Trainer {
    #[new]
    fn new(environment: &Bound<'_, PyAny>, plan: Plan<'_>) -> PyResult<Self> {
        build(environment, &plan).map(|built| Self(Mutex::new(built)))
    }

    /// Goes on until this many episodes are finished, counted from the run's beginning. Whatever interrupts it, what
    /// was learned before stays, and a further call goes on.
    fn advance(&self, py: Python<'_>, episodes: usize) -> PyResult<()> {
        let mut guard = self.lock()?;
        let built = &mut *guard;
        if built.attached {
            let until = Budget { episodes, steps: PYTHON_STEPS_BETWEEN_LOOKS };
            while built.run.episodes().returns.len() < episodes {
                built.run.advance(until)?;
                py.check_signals()?;
            }
            return Ok(());
        }
        let until = Budget { episodes, steps: STEPS_BETWEEN_LOOKS };
        let run = &mut built.run;
        door::detached(py, |stop| {
            while run.episodes().returns.len() < episodes && !stop.load(Ordering::Acquire) {
                run.advance(until)?;
            }
            Ok(())
        })?
        .map_err(|failure: crate::failure::Failure| failure.into())
    }

    /// The episodes finished `since` then: their returns, their lengths, and whether each ended in a terminal state.
    #[pyo3(signature = (since = 0))]
    fn episodes<'py>(&self, py: Python<'py>, since: usize) -> PyResult<Finished<'py>> {
        let built = self.lock()?;
        let episodes = built.run.episodes();
        let since = since.min(episodes.returns.len());
        Ok((
            PyArray1::from_slice(py, &episodes.returns[since..]),
            PyArray1::from_slice(py, &episodes.lengths[since..]),
            PyArray1::from_slice(py, &episodes.terminated[since..]),
        ))
    }

    /// The tables' values, one after the other, rows first.
    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_vec(py, self.lock()?.run.tables()))
    }

    /// The last finished episodes, oldest first: how each began, and its actions.
    fn recordings(&self, py: Python<'_>) -> PyResult<Vec<(Py<PyAny>, Vec<u32>)>> {
        let built = self.lock()?;
        match &built.kept {
            Kept::Nothing => Ok(Vec::new()),
            Kept::Native(recordings) => list(recordings)
                .iter()
                .map(|Recording { snapshot: start, actions }| {
                    Ok((start.into_pyobject(py)?.into_any().unbind(), actions.clone()))
                })
                .collect(),
            Kept::Python(recordings) => Ok(list(recordings)
                .iter()
                .map(|Recording { snapshot: start, actions }| (start.clone_ref(py), actions.clone()))
                .collect()),
        }
    }
}

impl Trainer {
    fn lock(&self) -> PyResult<MutexGuard<'_, Built>> {
        match self.0.try_lock() {
            Ok(guard) => Ok(guard),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "this trainer is at work in another thread, or called from its own environment",
            )),
        }
    }
}

fn list<S>(recordings: &Recordings<S>) -> MutexGuard<'_, VecDeque<Recording<S>>> {
    recordings.lock().unwrap_or_else(PoisonError::into_inner)
}
