//! `ExpectedUpdates`: planning by expected updates of single state-action pairs.

use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::planning::{ExpectedUpdates, UpdateDistribution};

use super::{of_policy, to_py_err};
use crate::convert::{Seed, array_from};
use crate::envs::PyNativeEnv;
use crate::interrupt::run_interruptible;
use crate::rng::environment_rng;

/// Planning over the table of an environment.
#[pyclass(name = "ExpectedUpdates", module = "qtab._core")]
pub(crate) struct PyExpectedUpdates {
    planning: ExpectedUpdates,
    discount: f64,
}

#[pymethods]
impl PyExpectedUpdates {
    /// With an `epsilon` the updates are distributed as in simulated episodes under the ε-greedy policy, otherwise
    /// uniformly. The random numbers are those of `np.random.default_rng(seed)`.
    #[new]
    fn new(py: Python<'_>, env: &PyNativeEnv, discount: f64, epsilon: Option<f64>, seed: Seed) -> PyResult<Self> {
        let mdp = env.shared().mdp()?.ok_or_else(|| PyValueError::new_err("env must have a transition table"))?;
        let distribution = epsilon.map_or(UpdateDistribution::Uniform, UpdateDistribution::OnPolicy);
        let rng = environment_rng(&seed);
        let planning =
            run_interruptible(py, |stop| ExpectedUpdates::new(mdp.table, discount, &distribution, rng, stop))?;
        Ok(Self { planning: planning.map_err(|error| to_py_err(error, discount))?, discount })
    }

    /// Makes this many updates.
    fn advance(&mut self, py: Python<'_>, updates: u64) -> PyResult<()> {
        let advanced = run_interruptible(py, |stop| self.planning.advance(updates, stop))?;
        advanced.map_err(|error| to_py_err(error, self.discount))
    }

    /// The action values, the actions of state 0 first.
    fn q_values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        array_from(py, self.planning.q_values())
    }

    /// The expected return of the greedy policy from the initial states.
    fn greedy_return(&self, py: Python<'_>) -> PyResult<f64> {
        let expected = run_interruptible(py, |stop| self.planning.greedy_return(stop))?;
        expected.map_err(|error| of_policy(error, self.discount))
    }
}
