//! `qtab/MaximizationBias-v0`, the example of maximisation bias.

use std::sync::Arc;

use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::envs::tabular::{MAXIMIZATION_BIAS_STATES, MaximizationBias};
use qtab_core::features::Identity;

use super::native_env::NativeEnv;
use crate::runs::{RunFactory, generic};
use crate::spec::RunSpec;

pub(crate) struct MaximizationBiasEnv(MaximizationBias);

impl MaximizationBiasEnv {
    pub(crate) fn from_gymnasium(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
        let py = env.py();
        Ok(Arc::new(Self(MaximizationBias {
            num_actions: env.getattr(intern!(py, "actions"))?.extract()?,
            mean: env.getattr(intern!(py, "mean"))?.extract()?,
            standard_deviation: env.getattr(intern!(py, "deviation"))?.extract()?,
        })))
    }
}

impl NativeEnv for MaximizationBiasEnv {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(MAXIMIZATION_BIAS_STATES as usize)?;
        generic(self.0, Identity(MAXIMIZATION_BIAS_STATES), spec)
    }
}
