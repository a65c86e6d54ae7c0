//! `Pendulum-v1`

use std::sync::Arc;

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::Env;
use qtab_core::envs::classic_control::Pendulum;
use qtab_core::numeric::Scalar;
use qtab_core::random::NoRng;

use super::reset::reset_f64;
use super::step::set_state;
use super::{ClassicEnv, EnvLayout, GymnasiumClass, ResetOutcome, StepResult, Stepped, runs_with_discrete_actions};
use crate::convert::{StateArray, box_action, numpy_scalar};
use crate::runs::RunFactory;
use crate::spec::RunSpec;

/// The last torque, used for rendering.
const LAST_TORQUE: &str = "last_u";

impl GymnasiumClass for Pendulum {
    fn py_reset<'py>(&self, generator: &Bound<'py, PyAny>) -> ResetOutcome<'py> {
        reset_f64(self, 2, generator)
    }

    fn py_step<'py>(&self, env: &Bound<'py, PyAny>, state: &StateArray, action: &Bound<'py, PyAny>) -> Stepped<'py> {
        let py = env.py();
        let Some((state, u)) = state.double_array().zip(box_action(action)) else { return Ok(None) };
        let step = self.step(<[f64; 2]>::into(state), u, &mut NoRng);
        let Some(mut result) = StepResult::new(py, self, step).if_finite() else { return Ok(None) };
        result.reward = numpy_scalar(py, Scalar::Double(step.reward))?;
        // Bypasses `__setattr__`, since no parameter changes.
        let attributes = env.getattr(intern!(py, "__dict__"))?.cast_into::<PyDict>()?;
        attributes.set_item(intern!(py, LAST_TORQUE), numpy_scalar(py, self.torque(u))?)?;
        Ok(Some(result))
    }
}

impl ClassicEnv for Pendulum {
    type States = Vec<<Self as Env>::State>;

    const LAYOUT: EnvLayout =
        EnvLayout { calls_numpy_trigonometry: true, last_action: Some(LAST_TORQUE), ..EnvLayout::new(2) };
    const ENVS_PER_THREAD: usize = 2048;

    fn snapshot(
        &self,
        attributes: &Bound<'_, PyDict>,
        state: &Self::State,
        last_action: Option<Scalar>,
    ) -> PyResult<()> {
        set_state::<2>(attributes, *state)?;
        let py = attributes.py();
        let torque = last_action.map(|u| numpy_scalar(py, self.torque(u))).transpose()?;
        attributes.set_item(intern!(py, LAST_TORQUE), torque)
    }

    fn runs(&self, actions: &[f32], spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        runs_with_discrete_actions(*self, actions, spec)
    }
}
