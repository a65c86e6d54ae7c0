//! `CartPole-v0` and `CartPole-v1`

use std::sync::Arc;

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::Env;
use qtab_core::envs::classic_control::{CartPole, CartPoleState};
use qtab_core::random::NoRng;
use qtab_core::vector::LaneStates;

use super::reset::reset_f64;
use super::step::set_state;
use super::{ClassicEnv, EnvLayout, ResetResult, StepResult};
use crate::convert::{StateArray, discrete_action};
use crate::runs::{OneStepBatching, RunFactory, specialized, tiled_box};
use crate::spec::{DiscretizerSpec, RunSpec};

impl ClassicEnv for CartPole {
    type States = LaneStates<4>;

    const LAYOUT: EnvLayout = EnvLayout {
        num_actions: Some(2),
        calls_numpy_trigonometry: true,
        terminal_counter: Some("steps_beyond_terminated"),
        ..EnvLayout::new(4)
    };
    const ENVS_PER_THREAD: usize = 16_384;

    fn reset_python<'py>(&self, generator: &Bound<'py, PyAny>) -> PyResult<Option<ResetResult<'py>>> {
        reset_f64(self, 4, generator).map(Some)
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
        let step = self.step(<[f64; 4]>::into(state), action, &mut NoRng);
        let result = StepResult::new(env.py(), self, step).if_finite();
        if result.is_some() && step.terminated {
            env.setattr(intern!(env.py(), "steps_beyond_terminated"), 0)?;
        }
        Ok(result)
    }

    fn snapshot(
        attributes: &Bound<'_, PyDict>,
        _env: &Self,
        state: &CartPoleState,
        _last_action: Option<usize>,
    ) -> PyResult<()> {
        set_state::<4>(attributes, *state)
    }

    fn runs(&self, _actions: &[f32], spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        if spec.prediction_by_observation().is_none()
            && let DiscretizerSpec::Bins(bins) = &spec.discretizer
            && let Some(grid) = bins.bins::<4>()
        {
            return specialized::<_, _, 2>(*self, grid, spec, OneStepBatching::in_lanes());
        }
        tiled_box::<_, 4, 2>(*self, spec)
    }
}
