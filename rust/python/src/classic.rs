//! Training on classic control: each model with each discretizer.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::envs::classic_control::Acrobot;
use qtab_core::envs::wrappers::DiscreteActions;
use qtab_core::features::MAX_TILINGS;
use qtab_core::numeric::Scalar;

use crate::discretizer::Discretizer;
use crate::learning::Built;
use crate::model::{Model, TORQUES};
use crate::native::{cold, hot};
use crate::plan::Plan;
use crate::trigonometry::single_precision;

/// A model with the constants of Gymnasium's environment.
#[pyclass(frozen, module = "qtab._core")]
pub(crate) struct Classic(Model);

#[pymethods]
impl Classic {
    /// `model` by its name; the constants are those of `environment`, as they are now.
    #[new]
    fn new(model: &str, environment: &Bound<'_, PyAny>) -> PyResult<Self> {
        let mut model = Model::new(model)?;
        if let Some(name) = model.read(environment)? {
            return Err(PyValueError::new_err(format!("Rust does not stand for its attribute {name}")));
        }
        if let Model::Acrobot(env) = &mut model {
            env.torques = environment.getattr(TORQUES)?.extract()?;
        }
        Ok(Self(model))
    }
}

/// A model, and the actions of a continuous one.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Control {
    constants: Py<Classic>,
    /// In the float32 of Gymnasium's action spaces; none where the model's actions are numbered.
    forces: Vec<f32>,
}

impl Control {
    pub(crate) fn build(&self, py: Python<'_>, plan: &Plan<'_>) -> PyResult<Built> {
        match self.constants.get().0 {
            Model::MountainCar(env) => match &plan.features {
                Discretizer::Rounding { scale } => hot::<_, _, 3>(env, plan.plane(scale)?, plan),
                _ => train(env, plan),
            },
            Model::CartPole(env) => match &plan.features {
                Discretizer::Bins { edges } => hot::<_, _, 2>(env, plan.bins::<4>(edges)?, plan),
                _ => train(env, plan),
            },
            Model::Acrobot(env) => {
                let foreign = || PyValueError::new_err("NumPy's single-precision sine and cosine are not known");
                train(Acrobot { f32_cos_sin: single_precision(py)?.ok_or_else(foreign)?, ..env }, plan)
            }
            Model::Pendulum(env) => train(self.few(env), plan),
            Model::ContinuousMountainCar(env) => train(self.few(env), plan),
        }
    }

    fn few<E: Env<Action = Scalar>>(&self, env: E) -> DiscreteActions<E> {
        DiscreteActions { env, actions: self.forces.iter().copied().map(Scalar::Single).collect() }
    }
}

/// An environment of `M` single-precision numbers, through a boxed world.
fn train<E, const M: usize>(env: E, plan: &Plan<'_>) -> PyResult<Built>
where
    E: Env<Action = usize, Observation = [f32; M], State: Send> + Send + 'static,
{
    if plan.low.len() != M {
        return Err(PyValueError::new_err(format!("an observation has {M} components, got {}", plan.low.len())));
    }
    match &plan.features {
        // Eight tilings are the usual number.
        Discretizer::Tiles { tilings: lit @ ..=8, .. } => cold(env, plan.tiles::<f32, 8>()?, *lit, plan),
        Discretizer::Tiles { tilings: lit, .. } => cold(env, plan.tiles::<f32, MAX_TILINGS>()?, *lit, plan),
        _ => cold(env, plan.grid(|bound| bound as f32)?, 1, plan),
    }
}
