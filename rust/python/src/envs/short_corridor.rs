//! `qtab/ShortCorridor-v0`, the short corridor with switched actions.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::envs::tabular::ShortCorridor;
use qtab_core::features::Identity;

use super::native_env::NativeEnv;
use crate::runs::{RunFactory, generic};
use crate::spec::RunSpec;

pub(crate) struct ShortCorridorEnv;

impl ShortCorridorEnv {
    #[expect(clippy::unnecessary_wraps, reason = "the registry has functions that may fail")]
    pub(crate) fn from_gymnasium(_env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
        Ok(Arc::new(Self))
    }
}

impl NativeEnv for ShortCorridorEnv {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(1)?;
        generic(ShortCorridor, Identity(1), spec)
    }
}
