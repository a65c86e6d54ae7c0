//! `MountainCar-v0`

use std::sync::Arc;

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use qtab_core::Env;
use qtab_core::envs::classic_control::{MountainCar, MountainCarState};
use qtab_core::numeric::Scalar;
use qtab_core::random::NoRng;
use qtab_core::vector::LaneStates;

use super::reset::reset_f64;
use super::step::set_state;
use super::{ClassicEnv, EnvLayout, ResetResult, StepResult};
use crate::convert::{StateArray, discrete_action, numpy_scalar};
use crate::runs::{OneStepBatching, RunFactory, specialized, tiled_box};
use crate::spec::{DiscretizerSpec, RunSpec};

impl ClassicEnv for MountainCar {
    type States = LaneStates<2>;

    const LAYOUT: EnvLayout = EnvLayout { state_is_tuple: true, num_actions: Some(3), ..EnvLayout::new(2) };
    const ENVS_PER_THREAD: usize = 32_768;

    fn reset_python<'py>(&self, generator: &Bound<'py, PyAny>) -> PyResult<Option<ResetResult<'py>>> {
        reset_f64(self, 1, generator).map(Some)
    }

    fn step_python<'py>(
        &self,
        env: &Bound<'py, PyAny>,
        state: &StateArray,
        action: &Bound<'py, PyAny>,
    ) -> PyResult<Option<StepResult<'py>>> {
        let Some((state, action)) = state.doubles().zip(discrete_action(action, self.num_actions())) else {
            return Ok(None);
        };
        let step = self.step(<[f64; 2]>::into(state), action, &mut NoRng);
        Ok(StepResult::new(env.py(), self, step).if_finite())
    }

    /// The state is an array after a reset, a tuple after a step.
    fn snapshot(
        attributes: &Bound<'_, PyDict>,
        _env: &Self,
        state: &MountainCarState,
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
