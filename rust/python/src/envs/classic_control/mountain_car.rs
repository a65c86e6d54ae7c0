//! `MountainCar-v0`

use std::sync::Arc;

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use qtab_core::envs::classic_control::MountainCar;
use qtab_core::numeric::Scalar;
use qtab_core::vector::LaneStates;

use super::reset::reset_f64;
use super::step::{discrete_step, set_state};
use super::{ClassicEnv, EnvLayout, GymnasiumClass, ResetOutcome, StepResult, Stepped};
use crate::convert::{StateArray, numpy_scalar};
use crate::runs::{OneStepBatching, RunFactory, specialized, tiled_box};
use crate::spec::{DiscretizerSpec, RunSpec};

impl GymnasiumClass for MountainCar {
    fn py_reset<'py>(&self, generator: &Bound<'py, PyAny>) -> ResetOutcome<'py> {
        reset_f64(self, 1, generator)
    }

    fn py_step<'py>(&self, env: &Bound<'py, PyAny>, state: &StateArray, action: &Bound<'py, PyAny>) -> Stepped<'py> {
        let Some(step) = discrete_step::<_, 2>(self, state, action) else { return Ok(None) };
        Ok(StepResult::new(env.py(), self, step).if_finite())
    }
}

impl ClassicEnv for MountainCar {
    type States = LaneStates<2>;

    const LAYOUT: EnvLayout = EnvLayout { state_is_tuple: true, num_actions: Some(3), ..EnvLayout::new(2) };
    const ENVS_PER_THREAD: usize = 32_768;

    /// The state is an array after a reset, a tuple after a step.
    fn snapshot(
        &self,
        attributes: &Bound<'_, PyDict>,
        state: &Self::State,
        last_action: Option<usize>,
    ) -> PyResult<()> {
        if last_action.is_none() {
            return set_state::<2>(attributes, *state);
        }
        let py = attributes.py();
        let numbers = <[f64; 2]>::from(*state).map(|number| numpy_scalar(py, Scalar::Double(number)));
        let numbers = numbers.into_iter().collect::<PyResult<Vec<_>>>()?;
        attributes.set_item(intern!(py, "state"), PyTuple::new(py, numbers)?)
    }

    fn runs(&self, _actions: &[f32], spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        if spec.prediction_by_observation().is_none()
            && let DiscretizerSpec::Round(round) = &spec.discretizer
            && let Some(grid) = round.rounding::<2>()
        {
            return specialized::<_, _, 3>(*self, grid, spec, OneStepBatching::in_lanes());
        }
        tiled_box::<_, 2, 3>(*self, spec)
    }
}
