//! A Gymnasium environment, stepped in Python, as the learner meets it.

use std::marker::PhantomData;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::features::{Features, Real};
use qtab_core::world::{Next, Transition, World};
use qtab_core::worlds::Start;

use crate::failure::Failure;
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
}

/// Observations of dtype `T` light rows by `F`.
pub(crate) struct PythonWorld<T, F> {
    environment: PythonEnvironment,
    seeded: bool,
    max_episode_steps: u64,
    features: F,
    dimensions: usize,
    dtype: PhantomData<T>,
}

impl<T: Real + numpy::Element, F: Features<[T]>> PythonWorld<T, F> {
    pub(crate) fn new(environment: PythonEnvironment, features: F, plan: &Plan<'_>) -> Self {
        Self {
            environment,
            seeded: false,
            max_episode_steps: plan.max_episode_steps.unwrap_or(u64::MAX),
            features,
            dimensions: plan.low.len(),
            dtype: PhantomData,
        }
    }

    fn misshapen(&self, observation: &Bound<'_, PyAny>) -> PyErr {
        match observation.getattr(intern!(observation.py(), "shape")) {
            Ok(shape) => PyValueError::new_err(format!(
                "an observation must have shape ({},), the space's, got {shape}",
                self.dimensions
            )),
            Err(error) => error,
        }
    }

    fn rows(&self, observation: &Bound<'_, PyAny>) -> Result<F::Rows, Failure> {
        let py = observation.py();
        let converted;
        let array = if let Ok(array) = observation.cast::<PyArray1<T>>() {
            array
        } else {
            // Not the space's dtype: read as the space says that it is meant.
            let arguments = (observation, numpy::dtype::<T>(py));
            let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "asarray"), arguments)?;
            converted = array.cast_into::<PyArray1<T>>().map_err(|error| self.misshapen(&error.into_inner()))?;
            &converted
        };
        if array.len()? != self.dimensions {
            return Err(self.misshapen(array).into());
        }
        let values = array.readonly();
        match values.as_slice() {
            Ok(values) => Ok(self.features.rows(values)?),
            Err(_) => Ok(self.features.rows(&values.as_array().to_vec())?),
        }
    }
}

impl<T: Real + numpy::Element, F: Features<[T]>> World for PythonWorld<T, F> {
    /// The steps taken since the reset.
    type State = u64;
    type Rows = F::Rows;
    type Error = Failure;

    fn reset(&mut self) -> Result<(u64, F::Rows), Failure> {
        Python::attach(|py| {
            let env = self.environment.env.bind(py);
            let seed = PyDict::new(py);
            if !self.seeded {
                seed.set_item(intern!(py, "seed"), &self.environment.seed)?;
            }
            let answer = env.call_method(intern!(py, "reset"), (), Some(&seed))?;
            self.seeded = true;
            Ok((0, self.rows(&answer.get_item(0)?)?))
        })
    }

    fn step(&mut self, elapsed: &mut u64, action: usize) -> Result<Transition<F::Rows>, Failure> {
        Python::attach(|py| {
            let env = self.environment.env.bind(py);
            let action = self.environment.first_action.saturating_add_unsigned(action as u64);
            let answer = env.call_method1(intern!(py, "step"), (action,))?;
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
            let rows = self.rows(&observation)?;
            let next = if terminated.is_truthy()? {
                Next::Terminal
            } else if truncated.is_truthy()? || *elapsed >= self.max_episode_steps {
                Next::TimedOut(rows)
            } else {
                Next::Goes(rows)
            };
            Ok(Transition { reward, next })
        })
    }
}

/// The state of the environment's own bit generator, a dict.
impl<T: Real + numpy::Element, F: Features<[T]>> Start for PythonWorld<T, F> {
    type Start = Py<PyAny>;

    fn start(&self) -> Result<Py<PyAny>, Failure> {
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
