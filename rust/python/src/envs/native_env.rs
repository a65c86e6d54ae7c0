//! What the binding needs of an environment that Rust steps.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::planning::Mdp;
use qtab_core::tasks::Testbed;

use crate::runs::RunFactory;
use crate::spec::RunSpec;
use crate::vector::{DynVectorEnv, VectorOptions};

/// An environment with its parameters fixed.
pub(crate) trait NativeEnv: Send + Sync {
    /// Training runs as the spec describes them, which record their last `record` episodes.
    fn runs(&self, spec: &Arc<RunSpec>, record: usize) -> PyResult<Box<dyn RunFactory>>;

    /// A vector environment; None where there is none.
    fn vector_env(&self, _py: Python<'_>, _options: VectorOptions) -> PyResult<Option<Box<dyn DynVectorEnv>>> {
        Ok(None)
    }

    /// The distribution of bandit problems; None for any other environment.
    fn testbed(&self) -> Option<Testbed> {
        None
    }

    /// The Markov decision process; None where it is not known.
    fn mdp(&self) -> PyResult<Option<Mdp>> {
        Ok(None)
    }
}
