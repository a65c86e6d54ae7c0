//! `MountainCarContinuous-v0`

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::Env;
use qtab_core::envs::classic_control::ContinuousMountainCar;
use qtab_core::numeric::Scalar;
use qtab_core::random::NoRng;

use super::reset::reset_f64;
use super::step::{set_f32_state, set_state};
use super::{
    ClassicEnv, EnvLayout, GymnasiumClass, ResetOutcome, StepResult, Stepped, StoredState, runs_with_discrete_actions,
};
use crate::convert::{StateArray, box_action};
use crate::runs::RunFactory;
use crate::spec::RunSpec;

impl GymnasiumClass for ContinuousMountainCar {
    fn py_reset<'py>(&self, generator: &Bound<'py, PyAny>) -> ResetOutcome<'py> {
        reset_f64(self, 1, generator)
    }

    fn py_step<'py>(&self, env: &Bound<'py, PyAny>, state: &StateArray, action: &Bound<'py, PyAny>) -> Stepped<'py> {
        let Some((state, action)) = state.scalars().zip(box_action(action)) else { return Ok(None) };
        let step = self.step(<[Scalar; 2]>::into(state), action, &mut NoRng);
        let mut result = StepResult::new::<_, 2, 2>(env.py(), self, step);
        // Gymnasium returns the state array itself as the observation.
        result.state = StoredState::Python(result.observation.clone().unbind());
        Ok(result.if_finite())
    }
}

impl ClassicEnv for ContinuousMountainCar {
    type States = Vec<<Self as Env>::State>;

    const LAYOUT: EnvLayout = EnvLayout::new(2);
    const ENVS_PER_THREAD: usize = 4096;

    /// The state is float64 after a reset, float32 after a step.
    fn snapshot(
        &self,
        attributes: &Bound<'_, PyDict>,
        state: &Self::State,
        last_action: Option<Scalar>,
    ) -> PyResult<()> {
        if last_action.is_none() {
            return set_state::<2>(attributes, *state);
        }
        set_f32_state(attributes, &self.observe(state))
    }

    fn runs(&self, actions: &[f32], spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        runs_with_discrete_actions(*self, actions, spec)
    }
}
