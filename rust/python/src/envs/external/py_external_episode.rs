//! `ExternalEpisode`: an episode that Python steps.

use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use numpy::PyArray1;
use pyo3::exceptions::{PyIndexError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use qtab_env::host::{CallError, Ending, Episode};

use super::capsule::with_bits_of;
use super::external_env::SharedEnv;
use super::observations::observation_array;
use super::py_external_env::PyExternalEnv;
use crate::convert::array_of;
use crate::error::{invalid, out_of_memory};

/// The episode of an environment of another library. Its generator is an argument: a bit generator of `NumPy`, whose lock
/// the caller holds.
#[pyclass(frozen, name = "ExternalEpisode", module = "qtab._core")]
pub(crate) struct PyExternalEpisode(Mutex<Episode<SharedEnv>>);

#[pymethods]
impl PyExternalEpisode {
    #[new]
    fn new(env: PyRef<'_, PyExternalEnv>) -> PyResult<Self> {
        let shared = env.shared();
        let size = shared.environment.state_size();
        Episode::new(SharedEnv(shared)).map(|episode| Self(Mutex::new(episode))).map_err(|_| out_of_memory(size))
    }

    /// Begins an episode.
    fn reset(&self, bit_generator: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut episode = self.lock()?;
        with_bits_of(bit_generator, |bits| episode.reset(bits))?.map_err(|error| failed("reset", error))
    }

    /// Takes a step. Returns the reward, and whether the next state is terminal, and whether the episode was cut off.
    fn step(&self, action: usize, bit_generator: &Bound<'_, PyAny>) -> PyResult<(f64, bool, bool)> {
        let mut episode = self.lock()?;
        let num_actions = episode.environment().num_actions();
        if action >= num_actions {
            return Err(PyIndexError::new_err(format!("action must be from 0 to {}, got {action}", num_actions - 1)));
        }
        let stepped = with_bits_of(bit_generator, |bits| episode.step(action, bits))?;
        let (reward, ending) = stepped.map_err(|error| failed("step", error))?;
        Ok((reward, ending == Ending::Terminated, ending == Ending::Truncated))
    }

    /// The last observation, as an array of its dtype.
    fn observation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        observation_array(py, &*self.lock()?)
    }

    /// The last action mask, as int8.
    fn action_mask<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i8>>> {
        array_of(py, self.lock()?.action_mask().iter().map(|&byte| byte.cast_signed()))
    }

    /// The bytes of the state.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, self.lock()?.state()))
    }

    /// Replaces the state by the bytes of another one of this environment, and writes its observation and action mask.
    fn set_state(&self, state: &[u8]) -> PyResult<()> {
        let mut episode = self.lock()?;
        let size = episode.state().len();
        if state.len() != size {
            return Err(invalid("state", format!("{size} bytes"), state.len()));
        }
        episode.set_state(state);
        episode.observe().map_err(|error| failed("observe", error))
    }
}

impl PyExternalEpisode {
    fn lock(&self) -> PyResult<MutexGuard<'_, Episode<SharedEnv>>> {
        match self.0.try_lock() {
            Ok(guard) => Ok(guard),
            Err(TryLockError::Poisoned(poisoned)) => Ok(PoisonError::into_inner(poisoned)),
            Err(TryLockError::WouldBlock) => {
                Err(PyRuntimeError::new_err("this environment is busy: another thread is stepping it"))
            }
        }
    }
}

fn failed(function: &str, error: CallError) -> PyErr {
    match error {
        CallError::Failed => {
            PyRuntimeError::new_err(format!("{function} of the environment failed: it returned QTAB_FAILED"))
        }
        error => PyValueError::new_err(error.to_string()),
    }
}
