//! Worlds of the core: an environment of Rust's with its features, its time limit and its own stream.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::random::Stream;
use qtab_core::worlds::Native;
use qtab_core::{Env, Features};

use crate::learning::{Built, Kept, boxed, whole};
use crate::plan::Plan;

/// On a grid. The article's learner of `N` actions, and its next of kin, are compiled whole.
pub(crate) fn hot<E, F, const N: usize>(env: E, features: F, plan: &Plan<'_>) -> PyResult<Built>
where
    E: Env<Action = usize, State: Send> + Send + 'static,
    F: Features<E::Observation, Rows = [u32; 1]> + Send + 'static,
{
    if let (true, 0, Stream::Pcg64(mut draw)) = (plan.actions == N && N == env.actions(), plan.record, plan.stream()?)
        && let Some(agent) = plan.article::<N>(features.len(), &mut draw)?
    {
        let world = Native::new(env, features, plan.max_episode_steps, plan.environment_stream());
        return Ok(Built { run: whole(world, agent, draw, plan), kept: Kept::Nothing, attached: false });
    }
    cold(env, features, 1, plan)
}

/// With any features; an observation lights so many rows.
pub(crate) fn cold<E, F>(env: E, features: F, lit: u32, plan: &Plan<'_>) -> PyResult<Built>
where
    E: Env<Action = usize, State: Send> + Send + 'static,
    F: Features<E::Observation, Rows: Send> + Send + 'static,
{
    if plan.actions != env.actions() {
        return Err(PyValueError::new_err(format!("the environment has {} actions", env.actions())));
    }
    let rows = features.len();
    let world = Native::new(env, features, plan.max_episode_steps, plan.environment_stream());
    boxed(world, rows, lit as usize, plan.stream()?, plan, Kept::Native, false)
}
