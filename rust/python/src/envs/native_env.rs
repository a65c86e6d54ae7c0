//! What the binding needs of an environment that Rust steps.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::planning::Mdp;

use crate::error::invalid;
use crate::runs::RunFactory;
use crate::spec::RunSpec;
use crate::vector::{DynVectorEnv, VectorOptions};

/// An environment with its parameters fixed.
pub(crate) trait NativeEnv: Send + Sync {
    /// Training runs as the spec describes them.
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>>;

    /// A vector environment; None where there is none.
    fn vector_env(&self, _py: Python<'_>, _options: VectorOptions) -> PyResult<Option<Box<dyn DynVectorEnv>>> {
        Ok(None)
    }

    /// Training runs on the k-armed testbed, which record whether the optimal action was taken.
    fn testbed_runs(&self, _spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        Err(invalid("env", "a k-armed bandit", "another environment"))
    }

    /// The Markov decision process; None where it is not known.
    fn mdp(&self) -> PyResult<Option<Mdp>> {
        Ok(None)
    }
}
