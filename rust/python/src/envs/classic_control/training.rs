//! Training in environments with continuous actions.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::envs::wrappers::DiscreteActions;
use qtab_core::numeric::Scalar;

use crate::runs::{RunFactory, generic_box};
use crate::spec::RunSpec;

/// Runs that choose from some of an environment's continuous actions.
pub(super) fn runs_with_discrete_actions<E, const M: usize>(
    env: E,
    actions: &[f32],
    spec: &Arc<RunSpec>,
) -> PyResult<Box<dyn RunFactory>>
where
    E: Env<Action = Scalar, Observation = [f32; M], State: Send> + Clone + Send + Sync + 'static,
{
    let actions = actions.iter().copied().map(Scalar::Single).collect();
    generic_box(DiscreteActions { env, actions }, spec)
}
