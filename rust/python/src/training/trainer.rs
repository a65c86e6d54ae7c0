//! One run, which Python advances step by step: `Trainer.advance` is its only long call.

use std::collections::VecDeque;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use qtab_core::checkpoint::{Checkpoint, CheckpointError};
use qtab_core::tasks::{Recording, Recordings};
use qtab_core::{Budget, EpisodeLog};

use super::STEPS_BETWEEN_CHECKS;
use super::env_spec::EnvironmentSpec;
use crate::convert::Seed;
use crate::error::{RunError, invalid};
use crate::interrupt::run_interruptible;
use crate::runs::{AnyRecordings, BuiltRun, python_run};
use crate::spec::{Fields, RunSpec};

/// As `STEPS_BETWEEN_CHECKS`, for steps in Python, each of which may take a millisecond.
const PYTHON_STEPS_BETWEEN_CHECKS: u64 = 64;

/// Returns, lengths, and whether each episode ended in a terminal state.
type FinishedEpisodes<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<bool>>);

/// The same, given.
type Episodes<'py> = (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, i64>, PyReadonlyArray1<'py, bool>);

/// A training run: the spec of `qtab/_spec.py`, a seed (a non-negative integer of any size), and how many of the last
/// episodes to record.
#[pyclass(frozen, name = "Trainer", module = "qtab._core")]
pub(crate) struct PyTrainer {
    built: Mutex<BuiltRun>,
    num_actions: usize,
}

#[pymethods]
impl PyTrainer {
    #[new]
    #[pyo3(signature = (spec, seed, record = 0))]
    fn new(spec: &Bound<'_, PyAny>, seed: Seed, record: usize) -> PyResult<Self> {
        let fields = Fields::new(spec)?;
        let run_spec = RunSpec::parse(&fields)?;
        let num_actions = run_spec.num_actions;
        let built = match EnvironmentSpec::parse(&fields.nested("env")?)? {
            EnvironmentSpec::Native(env) => env.runs(&Arc::new(run_spec), record)?.build(&seed)?,
            EnvironmentSpec::Python(env) => python_run(spec.py(), env, &run_spec, &seed, record)?,
        };
        Ok(Self { built: Mutex::new(built), num_actions })
    }

    /// Trains until `episodes` episodes are finished, counted from the start of the run. If it is interrupted, what was
    /// learned so far stays, and a further call resumes the run.
    fn advance(&self, py: Python<'_>, episodes: usize) -> PyResult<()> {
        let mut guard = self.lock()?;
        let BuiltRun { run, steps_python, .. } = &mut *guard;
        if *steps_python {
            let budget = Budget { episodes, steps: PYTHON_STEPS_BETWEEN_CHECKS };
            while run.episodes().returns.len() < episodes {
                run.advance(budget)?;
                py.check_signals()?;
            }
            return Ok(());
        }
        let budget = Budget { episodes, steps: STEPS_BETWEEN_CHECKS };
        let advanced: Result<(), RunError> = run_interruptible(py, |stop| {
            while run.episodes().returns.len() < episodes && !stop.load(Ordering::Acquire) {
                run.advance(budget)?;
            }
            Ok(())
        })?;
        advanced.map_err(PyErr::from)
    }

    /// The finished episodes from number `since` on: returns, lengths, whether each ended in a terminal state.
    #[pyo3(signature = (since = 0))]
    fn episodes<'py>(&self, py: Python<'py>, since: usize) -> PyResult<FinishedEpisodes<'py>> {
        let built = self.lock()?;
        let episodes = built.run.episodes();
        let since = since.min(episodes.returns.len());
        Ok((
            PyArray1::from_slice(py, &episodes.returns[since..]),
            PyArray1::from_slice(py, &episodes.lengths[since..]),
            PyArray1::from_slice(py, &episodes.terminated[since..]),
        ))
    }

    /// The values of all tables, one table after the other, rows first.
    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let built = self.lock()?;
        let tables = built.run.tables();
        let array = PyArray1::zeros(py, tables.iter().map(|table| table.len()).sum::<usize>(), false);
        {
            let mut values = array.try_readwrite()?;
            let mut rest = values.as_slice_mut()?;
            for table in tables {
                let (values, after) = rest.split_at_mut(table.len());
                values.copy_from_slice(table);
                rest = after;
            }
        }
        Ok(array)
    }

    /// All that is needed beside the tables and the finished episodes to resume the run exactly. Of an environment stepped
    /// in Python the generator is not part of it, and an unfinished episode is left out.
    fn checkpoint<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        self.lock()?.run.persist(self.num_actions, &mut Checkpoint::save(&mut bytes)).map_err(unusable)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Makes a new trainer of the same spec and seed (but for the number of episodes) the one that had these tables, these
    /// finished episodes and this checkpoint.
    fn resume(
        &self,
        checkpoint: &[u8],
        tables: Vec<PyReadonlyArray1<'_, f64>>,
        episodes: Episodes<'_>,
    ) -> PyResult<()> {
        let (returns, lengths, terminated) = episodes;
        let log =
            EpisodeLog { returns: returns.to_vec()?, lengths: lengths.to_vec()?, terminated: terminated.to_vec()? };
        if log.lengths.len() != log.returns.len() || log.terminated.len() != log.returns.len() {
            return Err(invalid("episodes", "three arrays of the same length", "others"));
        }
        let tables = tables.iter().map(PyReadonlyArray1::as_slice).collect::<Result<Vec<_>, _>>()?;
        let mut built = self.lock()?;
        built.run.resume(log, &tables).map_err(unusable)?;
        let mut checkpoint = Checkpoint::restore(checkpoint);
        built.run.persist(self.num_actions, &mut checkpoint).and_then(|()| checkpoint.finish()).map_err(unusable)
    }

    /// The recorded episodes, oldest first: the state of the environment's generator at their start, and the actions.
    fn recordings(&self, py: Python<'_>) -> PyResult<Vec<(Py<PyAny>, Vec<u32>)>> {
        let built = self.lock()?;
        match &built.recordings {
            AnyRecordings::None => Ok(Vec::new()),
            AnyRecordings::Native(recordings) => lock(recordings)
                .iter()
                .map(|Recording { snapshot, actions }| {
                    Ok((snapshot.into_pyobject(py)?.into_any().unbind(), actions.clone()))
                })
                .collect(),
            AnyRecordings::Python(recordings) => Ok(lock(recordings)
                .iter()
                .map(|Recording { snapshot, actions }| (snapshot.clone_ref(py), actions.clone()))
                .collect()),
        }
    }
}

impl PyTrainer {
    fn lock(&self) -> PyResult<MutexGuard<'_, BuiltRun>> {
        match self.built.try_lock() {
            Ok(guard) => Ok(guard),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "this trainer is at work in another thread, or called from its own environment",
            )),
        }
    }
}

fn unusable(error: CheckpointError) -> PyErr {
    match error {
        CheckpointError::OutOfMemory => PyMemoryError::new_err(format!("the checkpoint cannot be made: {error}")),
        _ => PyValueError::new_err(format!("the checkpoint does not fit the run: {error}")),
    }
}

fn lock<S>(recordings: &Recordings<S>) -> MutexGuard<'_, VecDeque<Recording<S>>> {
    recordings.lock().unwrap_or_else(PoisonError::into_inner)
}
