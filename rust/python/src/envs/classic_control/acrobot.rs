//! `Acrobot-v1`

use std::sync::Arc;

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::envs::classic_control::Acrobot;

use super::reset::{ResetResult, reset};
use super::step::{set_f32_state, set_state};
use super::trigonometry::{f32_cos_sin, f32_cos_sin_of_any_angle, numpy_uses_libm};
use super::{ClassicEnv, EnvLayout, GymnasiumClass, ResetOutcome, StepResult, Stepped};
use crate::convert::{StateArray, double, small_array};
use crate::runs::{RunFactory, generic_box};
use crate::spec::RunSpec;

/// The torque of each action.
const TORQUES: &str = "AVAIL_TORQUE";

impl GymnasiumClass for Acrobot {
    /// The initial state is float32.
    fn py_reset<'py>(&self, generator: &Bound<'py, PyAny>) -> ResetOutcome<'py> {
        let Some(f32_cos_sin) = f32_cos_sin(generator.py())? else { return Ok(None) };
        let (state, observation) = reset(&Acrobot { f32_cos_sin, ..*self }, 4, generator)?;
        let state = small_array(generator.py(), &<[f64; 4]>::from(state).map(|angle| angle as f32));
        Ok(Some(ResetResult { state: state.into_any(), observation }))
    }

    fn py_step<'py>(&self, env: &Bound<'py, PyAny>, state: &StateArray, action: &Bound<'py, PyAny>) -> Stepped<'py> {
        let py = env.py();
        let Some(mut torque) = double(&env.getattr(intern!(py, TORQUES))?.get_item(action)?) else { return Ok(None) };
        let state = <[f64; 4]>::into(state.numbers());
        let noise = self.torque_noise_max;
        if noise > 0.0 {
            let generator = env.getattr(intern!(py, "np_random"))?;
            torque += generator.call_method1(intern!(py, "uniform"), (-noise, noise))?.extract::<f64>()?;
            // The noise has been drawn, so this step can no longer fall back to Gymnasium's code.
            return Ok(Some(StepResult::new(py, self, self.transition(state, torque))));
        }
        Ok(StepResult::new(py, self, self.transition(state, torque)).if_finite())
    }
}

impl ClassicEnv for Acrobot {
    type States = Vec<<Self as qtab_core::Env>::State>;

    const LAYOUT: EnvLayout = EnvLayout { calls_numpy_trigonometry: true, ..EnvLayout::new(4) };
    const OTHER_PARAMETERS: &'static [&'static str] = &[TORQUES];
    const ENVS_PER_THREAD: usize = 512;

    fn read_other_parameters(&mut self, env: &Bound<'_, PyAny>) -> PyResult<()> {
        f32_cos_sin(env.py())?;
        self.f32_cos_sin = f32_cos_sin_of_any_angle;
        self.torques = env.getattr(TORQUES)?.extract()?;
        Ok(())
    }

    fn matches_numpy(py: Python<'_>) -> PyResult<bool> {
        Ok(numpy_uses_libm(py)? && f32_cos_sin(py)?.is_some())
    }

    /// The state is float32 after a reset, float64 after a step.
    fn snapshot(&self, attributes: &Bound<'_, PyDict>, state: &Self::State, _: Option<usize>) -> PyResult<()> {
        if state.is_f32 {
            return set_f32_state(attributes, &<[f64; 4]>::from(*state).map(|number| number as f32));
        }
        set_state::<4>(attributes, *state)
    }

    fn runs(&self, _actions: &[f32], spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        generic_box(*self, spec)
    }
}
