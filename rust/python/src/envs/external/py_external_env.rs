//! `ExternalEnv`: an environment in a capsule, as Python inspects it.

use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::random::{Pcg64, SeedSequence};
use qtab_env::host::{step_time, try_out};
use qtab_env::{FLOAT32, FLOAT64};

use super::super::native_env::{NativeEnv, PyNativeEnv};
use super::capsule::environment_of;
use super::external_env::{EnvironmentBits, ExternalEnv, SharedExternalEnv};
use super::external_vector_env::PySpaces;
use crate::convert::Seed;
use crate::rng::environment_rng;

/// The number of steps that are timed.
const TIMED_STEPS: u32 = 20;

/// The time of a step of Q-learning on a grid, which counts as a work of 1.
const NANOSECONDS_OF_WORK: u128 = 25;

/// The largest work of a step, more than that between two checks for Ctrl-C.
const LARGEST_WORK: u64 = 1 << 20;

/// An environment of another library. `capsule` is what `__qtab_env__()` returned, and is kept. Where a function of the
/// environment fails, `on_failure(state, before, action, seed, played)` is called: `state` are the bytes of the state
/// before the step, or None for a reset; `before` is the position of the run's generator, which was seeded with `seed`.
/// With `repeats_episodes`, `played` is the position before the episode and the actions since then, else None. It should
/// raise the error. If the call does not fail in Python, it may return its result, of type `Repeated`, and a function of
/// an action that takes the next step and returns the result.
#[pyclass(frozen, name = "ExternalEnv", module = "qtab._core")]
pub(crate) struct PyExternalEnv(Arc<ExternalEnv>);

#[pymethods]
impl PyExternalEnv {
    #[new]
    #[pyo3(signature = (capsule, on_failure = None, repeats_episodes = false))]
    pub(crate) fn new(
        capsule: &Bound<'_, PyAny>,
        on_failure: Option<Py<PyAny>>,
        repeats_episodes: bool,
    ) -> PyResult<Self> {
        let environment = environment_of(capsule)?;
        let mut rng = EnvironmentBits(Pcg64::new(&SeedSequence::new(&[0])));
        let nanoseconds = capsule.py().detach(|| step_time(&environment, TIMED_STEPS, &mut rng)).as_nanos();
        let step_work = u64::try_from(nanoseconds / NANOSECONDS_OF_WORK).unwrap_or(u64::MAX).min(LARGEST_WORK);
        let capsule = capsule.clone().unbind();
        Ok(Self(Arc::new(ExternalEnv { environment, step_work, _capsule: capsule, on_failure, repeats_episodes })))
    }

    /// The environment as training takes it. `first` are the numbers to subtract from those of an observation, so that
    /// indices begin at 0; empty for zeros. A vector environment needs `spaces`, an object with the attributes
    /// `first_action`, the action that is number 0, and `mask_dtype`, the dtype of the action masks in the infos or None,
    /// and two methods: `batch(rows)` makes the observations of a vector
    /// environment, and `single(row)` one observation, from the numbers that the functions of the library write.
    #[pyo3(signature = (first = Vec::new(), spaces = None))]
    pub(crate) fn native_env(&self, first: Vec<i64>, spaces: Option<&Bound<'_, PyAny>>) -> PyResult<PyNativeEnv> {
        let spaces = spaces.map(PySpaces::new).transpose()?;
        let shared = SharedExternalEnv { env: Arc::clone(&self.0), first, spaces };
        Ok(PyNativeEnv::from(Arc::new(shared) as Arc<dyn NativeEnv>))
    }

    /// The number of bytes of a state.
    #[getter]
    fn state_size(&self) -> usize {
        self.0.environment.state_size()
    }

    /// The dtype of an observation: "float32", "float64" or "int64".
    #[getter]
    fn dtype(&self) -> &'static str {
        match self.0.environment.observation_type() {
            FLOAT32 => "float32",
            FLOAT64 => "float64",
            _ => "int64",
        }
    }

    /// The lowest and the highest value of each number of an observation.
    #[getter]
    fn bounds(&self) -> Vec<(f64, f64)> {
        let environment = &self.0.environment;
        (0..environment.observation_size()).map(|index| (environment.low(index), environment.high(index))).collect()
    }

    /// The number of actions.
    #[getter]
    fn num_actions(&self) -> usize {
        self.0.environment.num_actions()
    }

    /// The time limit in steps, or None.
    #[getter]
    fn max_episode_steps(&self) -> Option<u64> {
        self.0.environment.max_episode_steps()
    }

    /// Whether the functions write an action mask.
    #[getter]
    fn has_action_mask(&self) -> bool {
        self.0.environment.has_action_mask()
    }

    /// Plays `steps` steps with random actions, and checks what the functions write. Raises a `ValueError` that names the
    /// rule of the interface that one of them breaks.
    fn try_out(&self, py: Python<'_>, steps: usize, seed: Seed) -> PyResult<()> {
        let mut rng = EnvironmentBits(environment_rng(&seed));
        let tried = py.detach(|| try_out(&self.0.environment, steps, &mut rng));
        tried.map_err(|error| PyValueError::new_err(error.to_string()))
    }
}

impl PyExternalEnv {
    pub(super) fn shared(&self) -> Arc<ExternalEnv> {
        Arc::clone(&self.0)
    }
}
