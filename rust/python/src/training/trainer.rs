//! One run, which Python advances step by step. `Trainer.advance` is its only long call.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use qtab_core::checkpoint::{Checkpoint, CheckpointError, EpisodeProgress};
use qtab_core::memory::with_capacity;
use qtab_core::tasks::{Recording, Recordings};
use qtab_core::{Budget, EpisodeLog};

use super::env_spec::EnvironmentSpec;
use super::{Memory, WORK_BETWEEN_CHECKS, room_of};
use crate::convert::{Seed, array_of};
use crate::error::{RunError, allocation, invalid, unusable_checkpoint};
use crate::interrupt::{run_detached, run_polling, run_resumable};
use crate::locks::lock;
use crate::runs::{AnyRecordings, BuiltRun, Run, check_tables, python_task};
use crate::spec::{Fields, InitialQSpec, RunSpec};

/// Returns, lengths, and whether each episode ended in a terminal state.
type FinishedEpisodes<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<bool>>);

/// Finished episodes as an argument: returns, lengths, and whether each ended in a terminal state.
type Episodes<'py> = (PyReadonlyArray1<'py, f64>, PyReadonlyArray1<'py, i64>, PyReadonlyArray1<'py, bool>);

/// The generator's state at the start of an episode, and the episode's actions.
type PyRecording<'py> = (Py<PyAny>, Bound<'py, PyArray1<u32>>);

/// A training run. The arguments are the spec of `qtab/_spec.py`, a seed (a non-negative integer of any size), the
/// number of last episodes to record, the memory limit in bytes with the bytes left for data that grows during the run,
/// and whether to count the visits of each state-action pair.
#[pyclass(frozen, name = "Trainer", module = "qtab._core")]
pub(crate) struct PyTrainer {
    run: Mutex<BuiltRun>,
    initial_q: InitialQSpec,
    /// Whether the results have been taken out.
    over: AtomicBool,
}

#[pymethods]
impl PyTrainer {
    #[new]
    #[pyo3(signature = (spec, seed, record = 0, memory = None, visits = false))]
    fn new(spec: &Bound<'_, PyAny>, seed: Seed, record: usize, memory: Option<Memory>, visits: bool) -> PyResult<Self> {
        let (py, fields, room) = (spec.py(), Fields::new(spec)?, room_of(memory));
        let run_spec = RunSpec { record, room: room.clone(), count_visits: visits, ..RunSpec::parse(&fields)? };
        let environment = EnvironmentSpec::parse(&fields.nested("env")?)?;
        let initial_q = run_spec.initial_q.clone();
        // Filling a large table takes seconds.
        let built = match environment {
            EnvironmentSpec::Native(env) => run_detached(py, |stop| env.runs(&Arc::new(run_spec))?.build(&seed, stop))?,
            EnvironmentSpec::Python(env) => {
                let task = python_task(py, env, &run_spec, &seed)?;
                run_detached(py, |stop| task.build(stop))?
            }
        };
        let mut built = built?;
        built.run.limit_memory(room);
        Ok(Self { run: Mutex::new(built), initial_q, over: AtomicBool::new(false) })
    }

    /// Trains until `episodes` episodes are finished, counted from the start of the run. After an interruption, the
    /// learned values are kept, and another call resumes the run.
    fn advance(&self, py: Python<'_>, episodes: usize) -> PyResult<()> {
        let mut guard = self.lock()?;
        if self.over.load(Ordering::Acquire) {
            return Err(PyRuntimeError::new_err("this trainer's results were taken: it cannot train further"));
        }
        let BuiltRun { run, steps_python, .. } = &mut *guard;
        let advanced = if *steps_python {
            run_polling(|stop| advance_until(run.as_mut(), episodes, &|| stop.is_set()))?.map(drop)
        } else {
            run_resumable(py, |pauses| advance_until(run.as_mut(), episodes, pauses))?
        };
        advanced.map_err(PyErr::from)
    }

    /// Raises `OverflowError` if the values of the tables have overflowed.
    fn check_tables(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| Ok(check_tables(&*self.lock()?.run, &self.initial_q)?))
    }

    /// The finished episodes from number `since` on: returns, lengths, whether each ended in a terminal state.
    #[pyo3(signature = (since = 0))]
    fn episodes<'py>(&self, py: Python<'py>, since: usize) -> PyResult<FinishedEpisodes<'py>> {
        let built = self.lock()?;
        let episodes = built.run.episodes();
        let since = since.min(episodes.returns.len());
        Ok((
            array_of(py, episodes.returns[since..].iter().copied())?,
            array_of(py, episodes.lengths[since..].iter().copied())?,
            array_of(py, episodes.terminated[since..].iter().copied())?,
        ))
    }

    /// All finished episodes, moved out without a copy, for which memory might not suffice. This ends the training.
    fn take_episodes<'py>(&self, py: Python<'py>) -> PyResult<FinishedEpisodes<'py>> {
        let mut built = self.lock()?;
        self.over.store(true, Ordering::Release);
        let EpisodeLog { returns, lengths, terminated } = built.run.take_episodes();
        Ok((PyArray1::from_vec(py, returns), PyArray1::from_vec(py, lengths), PyArray1::from_vec(py, terminated)))
    }

    /// The values of all tables, one table after the other, rows first.
    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let copy = || {
            let built = self.lock()?;
            let tables = built.run.tables();
            let size = tables.iter().map(|table| table.len()).sum();
            let mut values = with_capacity(size).map_err(allocation)?;
            for table in tables {
                values.extend_from_slice(table);
            }
            PyResult::Ok(values)
        };
        Ok(PyArray1::from_vec(py, py.detach(copy)?))
    }

    /// The data that resumes the run exactly, together with the tables and the finished episodes. For an environment
    /// stepped in Python, the generator and an unfinished episode are not included.
    fn checkpoint<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let save = || {
            let mut bytes = Vec::new();
            self.lock()?.run.persist(&mut Checkpoint::save(&mut bytes)).map_err(unusable)?;
            PyResult::Ok(bytes)
        };
        let bytes = py.detach(save)?;
        PyBytes::new_with(py, bytes.len(), |copy| {
            copy.copy_from_slice(&bytes);
            Ok(())
        })
    }

    /// Restores a run from its tables, finished episodes and checkpoint, in a new trainer of the same spec and seed
    /// (except for the number of episodes). Returns whether the checkpoint was made within an episode that cannot be
    /// continued: the run then resumes with the next one.
    fn restore(
        &self,
        py: Python<'_>,
        checkpoint: &[u8],
        tables: Vec<PyReadonlyArray1<'_, f64>>,
        episodes: Episodes<'_>,
    ) -> PyResult<bool> {
        let (returns, lengths, terminated) = episodes;
        let log =
            EpisodeLog { returns: returns.to_vec()?, lengths: lengths.to_vec()?, terminated: terminated.to_vec()? };
        if log.lengths.len() != log.returns.len() || log.terminated.len() != log.returns.len() {
            return Err(invalid("episodes", "three arrays of the same length", "others"));
        }
        let tables = tables.iter().map(PyReadonlyArray1::as_slice).collect::<Result<Vec<_>, _>>()?;
        let restore = || {
            let mut built = self.lock()?;
            built.run.restore(log, &tables).map_err(unusable)?;
            let mut checkpoint = Checkpoint::restore(checkpoint);
            let progress = built.run.persist(&mut checkpoint).map_err(unusable)?;
            checkpoint.finish().map_err(unusable)?;
            Ok(progress == EpisodeProgress::Abandoned)
        };
        py.detach(restore)
    }

    /// The number of times each action was taken in each row, rows first; None if visits are not counted.
    fn visits<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<i64>>>> {
        self.lock()?.run.visits().map(|visits| array_of(py, visits.iter().copied())).transpose()
    }

    /// The available actions of each state when it was last seen, rows first; with tile coding, those of the last
    /// state. None without action masks.
    fn action_masks<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<bool>>>> {
        self.lock()?.run.action_masks().map(|masks| array_of(py, masks.iter().copied())).transpose()
    }

    /// The number of updates made from a model; None if they are not counted.
    fn planning_updates(&self) -> PyResult<Option<u64>> {
        Ok(self.lock()?.run.planning_updates())
    }

    /// The estimate of the average reward; None if none is learned.
    fn average_reward(&self) -> PyResult<Option<f64>> {
        Ok(self.lock()?.run.average_reward())
    }

    /// The recorded episodes, oldest first, moved out. This ends the training.
    fn take_recordings<'py>(&self, py: Python<'py>) -> PyResult<Vec<PyRecording<'py>>> {
        let built = self.lock()?;
        self.over.store(true, Ordering::Release);
        match &built.recordings {
            AnyRecordings::None | AnyRecordings::OptimalActions(_) => Ok(Vec::new()),
            AnyRecordings::Native(recordings) => take(recordings)
                .into_iter()
                .map(|Recording { snapshot, actions }| {
                    Ok((snapshot.into_pyobject(py)?.into_any().unbind(), PyArray1::from_vec(py, actions)))
                })
                .collect(),
            AnyRecordings::Python(recordings) => Ok(take(recordings)
                .into_iter()
                .map(|Recording { snapshot, actions }| (snapshot, PyArray1::from_vec(py, actions)))
                .collect()),
        }
    }
}

impl PyTrainer {
    fn lock(&self) -> PyResult<MutexGuard<'_, BuiltRun>> {
        match self.run.try_lock() {
            Ok(guard) => Ok(guard),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "this trainer is busy in another thread, or was called from its own environment",
            )),
        }
    }
}

/// Trains until `episodes` episodes are finished, or until `pauses`, which is called every fraction of a millisecond,
/// returns true. Returns whether they are finished.
fn advance_until(run: &mut dyn Run, episodes: usize, pauses: &dyn Fn() -> bool) -> Result<bool, RunError> {
    let is_finished = |run: &dyn Run| run.episodes().returns.len() >= episodes;
    while !is_finished(run) && !pauses() {
        run.advance(Budget { episodes, work: WORK_BETWEEN_CHECKS })?;
    }
    Ok(is_finished(run))
}

fn unusable(error: CheckpointError) -> PyErr {
    unusable_checkpoint(error, "run")
}

fn take<S>(recordings: &Recordings<S>) -> VecDeque<Recording<S>> {
    std::mem::take(&mut lock(recordings))
}
