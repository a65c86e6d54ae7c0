//! A [`ClassicEnv`] whose type is known only at run time.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::envs::Parameters;

use super::super::native_env::NativeEnv;
use super::{ClassicEnv, DynClassicEnv, EnvLayout};
use crate::convert::constant;
use crate::error::invalid;
use crate::runs::RunFactory;
use crate::spec::RunSpec;
use crate::vector::{DynVectorEnv, EnvInfo, VectorOptions, native_vector_env};

impl<E: ClassicEnv> DynClassicEnv for E {
    fn layout(&self) -> &'static EnvLayout {
        &E::LAYOUT
    }

    fn matches_numpy(&self, py: Python<'_>) -> PyResult<bool> {
        E::matches_numpy(py)
    }

    fn parameter_names(&self) -> Vec<&'static str> {
        let flags = E::FLAGS.iter().map(|flag| flag.name);
        E::NAMES.iter().copied().chain(flags).chain(E::OTHER_PARAMETERS.iter().copied()).collect()
    }

    fn with_parameters(&self, env: &Bound<'_, PyAny>) -> PyResult<Result<Arc<dyn DynClassicEnv>, &'static str>> {
        let mut read = *self;
        Ok(match read_parameters(&mut read, env)? {
            None => Ok(Arc::new(read)),
            Some(name) => Err(name),
        })
    }

    fn native_env(&self, env: &Bound<'_, PyAny>, actions: Vec<f32>) -> PyResult<Arc<dyn NativeEnv>> {
        let mut read = *self;
        if let Some(name) = read_parameters(&mut read, env)? {
            let value = env
                .getattr_opt(name)?
                .map_or_else(|| Ok("none".into()), |value| value.repr().map(|text| text.to_string()))?;
            return Err(invalid(&format!("the attribute {name}"), "a value that Rust can compute with", value));
        }
        read.read_other_parameters(env)?;
        Ok(Arc::new(ClassicControl { env: read, actions }))
    }
}

/// Reads the numbers and flags from Gymnasium's environment. Returns the name of the first one that Rust does not
/// support, such as a number of another width.
pub(super) fn read_parameters<P: Parameters>(
    parameters: &mut P,
    env: &Bound<'_, PyAny>,
) -> PyResult<Option<&'static str>> {
    for &name in P::NAMES {
        let value = env.getattr_opt(name)?;
        let (Some(parameter), Some(number)) = (parameters.parameter(name), value.and_then(|value| constant(&value)))
        else {
            return Ok(Some(name));
        };
        *parameter = number;
    }
    for flag in P::FLAGS {
        let value = env.getattr_opt(flag.name)?;
        let (Some(on), Some(value)) = (parameters.flag(flag.name), value) else { return Ok(Some(flag.name)) };
        *on = flag.true_value.map_or_else(|| value.is_truthy(), |word| value.eq(word))?;
    }
    Ok(None)
}

/// An environment with its parameters fixed, and the available actions if its action space is continuous.
struct ClassicControl<E> {
    env: E,
    /// In float32, the dtype of Gymnasium's action spaces; empty for discrete actions.
    actions: Vec<f32>,
}

impl<E: ClassicEnv> NativeEnv for ClassicControl<E> {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        self.env.runs(&self.actions, spec)
    }

    fn vector_env(&self, py: Python<'_>, options: VectorOptions) -> PyResult<Option<Box<dyn DynVectorEnv>>> {
        let info = EnvInfo {
            envs_per_thread: E::ENVS_PER_THREAD,
            transition: None,
            snapshot: |attributes, env: &E, state, last_action| env.snapshot(attributes, state, last_action),
            terminal_counter: E::LAYOUT.terminal_counter,
        };
        native_vector_env::<_, E::States>(py, self.env, info, options).map(Some)
    }
}
