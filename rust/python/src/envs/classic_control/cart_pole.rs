//! `CartPole-v0` and `CartPole-v1`

use std::sync::Arc;

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::envs::classic_control::CartPole;
use qtab_core::vector::LaneStates;

use super::reset::reset_f64;
use super::step::{discrete_step, set_state};
use super::{ClassicEnv, EnvLayout, GymnasiumClass, ResetOutcome, StepResult, Stepped};
use crate::convert::StateArray;
use crate::runs::{OneStepBatching, RunFactory, specialized, tiled_box};
use crate::spec::{DiscretizerSpec, RunSpec};

impl GymnasiumClass for CartPole {
    fn py_reset<'py>(&self, generator: &Bound<'py, PyAny>) -> ResetOutcome<'py> {
        reset_f64(self, 4, generator)
    }

    fn py_step<'py>(&self, env: &Bound<'py, PyAny>, state: &StateArray, action: &Bound<'py, PyAny>) -> Stepped<'py> {
        let Some(step) = discrete_step::<_, 4>(self, state, action) else { return Ok(None) };
        let result = StepResult::new(env.py(), self, step).if_finite();
        if result.is_some() && step.terminated {
            env.setattr(intern!(env.py(), "steps_beyond_terminated"), 0)?;
        }
        Ok(result)
    }
}

impl ClassicEnv for CartPole {
    type States = LaneStates<4>;

    const LAYOUT: EnvLayout = EnvLayout {
        num_actions: Some(2),
        calls_numpy_trigonometry: true,
        terminal_counter: Some("steps_beyond_terminated"),
        ..EnvLayout::new(4)
    };
    const ENVS_PER_THREAD: usize = 16_384;

    fn snapshot(&self, attributes: &Bound<'_, PyDict>, state: &Self::State, _: Option<usize>) -> PyResult<()> {
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
