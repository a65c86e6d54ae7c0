//! `NativeEnv`: an environment that Rust steps, as Python passes it to training, planning and vector environments.

use std::sync::Arc;

use pyo3::prelude::*;

use super::native_env::NativeEnv;
use super::registry::{Entry, entry};

/// An environment with the parameters, the table or the rules of Gymnasium's environment.
#[pyclass(frozen, name = "NativeEnv", module = "qtab._core")]
pub(crate) struct PyNativeEnv(Arc<dyn NativeEnv>);

#[pymethods]
impl PyNativeEnv {
    /// `name` is a name of the registry, `env` the unwrapped Gymnasium environment, whose attributes are read now.
    /// `actions` are what a learner chooses from where the action space is continuous.
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

impl PyNativeEnv {
    pub(crate) fn shared(&self) -> Arc<dyn NativeEnv> {
        Arc::clone(&self.0)
    }
}
