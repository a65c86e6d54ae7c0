//! A Gymnasium environment, stepped in Python, as the learner meets it.

use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::Task;
use qtab_core::tasks::RngSnapshot;
use qtab_core::tasks::{Next, Transition};

use crate::failure::Failure;
use crate::observation::Reader;
use crate::plan::Plan;

/// What Python hands over besides the plan.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct PythonEnvironment {
    env: Py<PyAny>,
    /// The seed of the first reset, a Python integer.
    seed: Py<PyAny>,
    /// The first action of the space, `Discrete.start`.
    first_action: i64,
    /// The arrays that stand for the actions of a continuous space; none for a discrete one.
    choices: Vec<Py<PyAny>>,
}

impl PythonEnvironment {
    /// What the environment's step takes. An array is a copy, which the environment may write to.
    fn action<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyAny>> {
        match self.choices.get(index) {
            Some(choice) => choice.bind(py).call_method0(intern!(py, "copy")),
            None => Ok(self.first_action.saturating_add_unsigned(index as u64).into_pyobject(py)?.into_any()),
        }
    }
}

/// An environment whose observations light rows by `R`.
pub(crate) struct PythonWorld<R> {
    environment: PythonEnvironment,
    seeded: bool,
    max_episode_steps: u64,
    reader: R,
}

impl<R> PythonWorld<R> {
    pub(crate) fn new(environment: PythonEnvironment, reader: R, plan: &Plan<'_>) -> Self {
        let max_episode_steps = plan.max_episode_steps.unwrap_or(u64::MAX);
        Self { environment, seeded: false, max_episode_steps, reader }
    }
}

impl<R: Reader> Task for PythonWorld<R> {
    /// The steps taken since the reset.
    type State = u64;
    type Active = R::Rows;
    type Error = Failure;

    fn reset(&mut self) -> Result<(u64, R::Rows), Failure> {
        Python::attach(|py| {
            let env = self.environment.env.bind(py);
            let seed = PyDict::new(py);
            if !self.seeded {
                seed.set_item(intern!(py, "seed"), &self.environment.seed)?;
            }
            let answer = env.call_method(intern!(py, "reset"), (), Some(&seed))?;
            self.seeded = true;
            Ok((0, self.reader.rows(&answer.get_item(0)?)?))
        })
    }

    fn step(&mut self, elapsed: &mut u64, action: usize) -> Result<Transition<R::Rows>, Failure> {
        Python::attach(|py| {
            let env = self.environment.env.bind(py);
            let answer = env.call_method1(intern!(py, "step"), (self.environment.action(py, action)?,))?;
            let (observation, reward, terminated, truncated, _info): (
                Bound<'_, PyAny>,
                f64,
                Bound<'_, PyAny>,
                Bound<'_, PyAny>,
                Bound<'_, PyAny>,
            ) = answer.extract()?;
            if !reward.is_finite() {
                let message = format!("the environment's reward is {reward}, which no value can be learned from");
                return Err(PyValueError::new_err(message).into());
            }
            *elapsed += 1;
            let rows = self.reader.rows(&observation)?;
            let next = if terminated.is_truthy()? {
                Next::Terminal
            } else if truncated.is_truthy()? || *elapsed >= self.max_episode_steps {
                Next::Truncated(rows)
            } else {
                Next::NonTerminal(rows)
            };
            Ok(Transition { reward, next })
        })
    }
}

/// The state of the environment's own bit generator, a dict.
impl<R: Reader> RngSnapshot for PythonWorld<R> {
    type Snapshot = Py<PyAny>;

    fn rng_snapshot(&self) -> Result<Py<PyAny>, Failure> {
        Python::attach(|py| {
            let env = self.environment.env.bind(py);
            if !self.seeded {
                // Seeding is the reset's own work.
                return Ok(self.environment.seed.clone_ref(py));
            }
            let generator = env.getattr(intern!(py, "unwrapped"))?.getattr(intern!(py, "np_random"))?;
            Ok(generator.getattr(intern!(py, "bit_generator"))?.getattr(intern!(py, "state"))?.unbind())
        })
    }
}
