//! Worlds of the core: an environment of Rust's with its features, its time limit and its own stream.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::learners::Agent;
use qtab_core::policies::Policy;
use qtab_core::random::{AgentRng, Pcg64};
use qtab_core::schedules::Schedule;
use qtab_core::tasks::NativeTask;
use qtab_core::{Env, Features};

use crate::learning::{Built, Kept, boxed, whole};
use crate::plan::Plan;

/// On a grid. The article's learner of `N` actions, and its next of kin, are compiled whole; with other policies, too.
pub(crate) fn hot<E, F, const N: usize>(env: E, features: F, plan: &Plan<'_>) -> PyResult<Built>
where
    E: Env<Action = usize, State: Send> + Send + 'static,
    F: Features<E::Observation, Active = [u32; 1]> + Send + 'static,
{
    if let (true, 0, AgentRng::Pcg64(mut draw)) =
        (plan.actions == N && N == env.num_actions(), plan.record, plan.stream()?)
    {
        let rows = features.len();
        if let Some(agent) = plan.article::<N>(rows, &mut draw)? {
            return Ok(alone(env, features, agent, draw, plan));
        }
        if let Some(agent) = plan.plain::<N, _>(plan.policy()?, rows, &mut draw)? {
            return Ok(alone(env, features, agent, draw, plan));
        }
    }
    cold(env, features, 1, plan)
}

fn alone<E, F, P, const N: usize>(
    env: E,
    features: F,
    agent: Agent<N, P, Schedule>,
    draw: Pcg64,
    plan: &Plan<'_>,
) -> Built
where
    E: Env<Action = usize, State: Send> + Send + 'static,
    F: Features<E::Observation, Active = [u32; 1]> + Send + 'static,
    P: Policy + Send + 'static,
{
    let world = NativeTask::new(env, features, plan.max_episode_steps, plan.environment_stream());
    Built { run: whole(world, agent, draw, plan), kept: Kept::Nothing, attached: false }
}

/// With any features; an observation lights so many rows.
pub(crate) fn cold<E, F>(env: E, features: F, lit: u32, plan: &Plan<'_>) -> PyResult<Built>
where
    E: Env<Action = usize, State: Send> + Send + 'static,
    F: Features<E::Observation, Active: Send> + Send + 'static,
{
    if plan.actions != env.num_actions() {
        return Err(PyValueError::new_err(format!("the environment has {} actions", env.num_actions())));
    }
    let rows = features.len();
    let world = NativeTask::new(env, features, plan.max_episode_steps, plan.environment_stream());
    boxed(world, rows, lit as usize, plan.stream()?, plan, Kept::Native, false)
}
