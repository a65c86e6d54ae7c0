//! An environment that Rust steps, as Python passes it to training, planning and vector environments.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::planning::Mdp;

use super::registry::{Entry, entry};
use crate::error::invalid;
use crate::runs::RunFactory;
use crate::spec::RunSpec;
use crate::vector::{DynVectorEnv, VectorOptions};

/// An environment with its parameters fixed.
pub(crate) trait NativeEnv: Send + Sync {
    /// Training runs as the spec describes them.
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>>;

    /// A vector environment; None if Rust has none for this environment.
    fn vector_env(&self, _py: Python<'_>, _options: VectorOptions) -> PyResult<Option<Box<dyn DynVectorEnv>>> {
        Ok(None)
    }

    /// Training runs on the k-armed testbed, which record whether the optimal action was taken.
    fn testbed_runs(&self, _spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        Err(invalid("env", "a k-armed bandit", "another environment"))
    }

    /// The Markov decision process; None if it is not known.
    fn mdp(&self) -> PyResult<Option<Mdp>> {
        Ok(None)
    }
}

/// An environment with the parameters, the table or the rules of Gymnasium's environment.
#[pyclass(frozen, name = "NativeEnv", module = "qtab._core")]
pub(crate) struct PyNativeEnv(Arc<dyn NativeEnv>);

#[pymethods]
impl PyNativeEnv {
    /// `name` is a name in the registry, and `env` the unwrapped Gymnasium environment, whose attributes are read now.
    /// If the action space is continuous, the learner chooses from `actions`.
    #[new]
    #[pyo3(signature = (name, env, actions = Vec::new()))]
    fn new(name: &str, env: &Bound<'_, PyAny>, actions: Vec<f32>) -> PyResult<Self> {
        let env = match entry(name)? {
            Entry::ClassicControl(new) => new().native_env(env, actions)?,
            Entry::FromGymnasium(read) => read(env)?,
        };
        Ok(Self(env))
    }
}

impl From<Arc<dyn NativeEnv>> for PyNativeEnv {
    fn from(env: Arc<dyn NativeEnv>) -> Self {
        Self(env)
    }
}

impl PyNativeEnv {
    pub(crate) fn shared(&self) -> Arc<dyn NativeEnv> {
        Arc::clone(&self.0)
    }
}
