//! The core's agents, built from a spec.

use pyo3::prelude::*;
use qtab_core::StopFlag;
use qtab_core::learners::{Agent, AnyAlgorithm};
use qtab_core::random::Rng;

use crate::error::allocation;
use crate::spec::RunSpec;

/// An agent with any learner, and its initial table.
pub(super) fn generic_agent(
    spec: &RunSpec,
    n_rows: usize,
    n_active: usize,
    rng: &mut impl Rng,
    stop: &StopFlag<'_>,
) -> PyResult<Agent> {
    let shape = (n_rows, spec.num_actions);
    let masks = match spec.algorithm {
        // These algorithms choose some actions regardless of the values: untried ones, or the first of an episode.
        AnyAlgorithm::DynaQPlus { .. } | AnyAlgorithm::MonteCarloEs { .. } if spec.action_masks.is_none() => {
            spec.initial_q.masks(n_rows * spec.num_actions, spec.num_actions)?
        }
        _ => spec.action_masks.build(shape, n_active, stop)?,
    };
    let has_masks = spec.initial_q.has_masked_actions() || !spec.action_masks.is_none();
    Ok(Agent {
        table: spec.initial_q.table((0, spec.algorithm.n_tables()), shape, rng, stop)?,
        policy: spec.policy.build(spec.episodes, shape, has_masks, stop).map_err(allocation)?,
        learning_rate: spec.new_learning_rate(n_rows * spec.num_actions, n_active, stop)?,
        discount: spec.discount,
        terminal_update: spec.terminal_update,
        masks,
    })
}
