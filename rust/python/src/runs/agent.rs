//! The core's agents, as a spec describes them.

use pyo3::prelude::*;
use qtab_core::StopFlag;
use qtab_core::learners::{Agent, AnyAlgorithm};
use qtab_core::memory::AllocationError;
use qtab_core::policies::{AnyPolicy, Ucb};
use qtab_core::random::Rng;
use qtab_core::schedules::LearningRate;

use crate::error::allocation;
use crate::spec::{LearningRateSpec, PolicySpec, RunSpec};

/// The agent of any learner, with its first table.
pub(super) fn generic_agent(
    spec: &RunSpec,
    n_rows: usize,
    n_active: usize,
    rng: &mut impl Rng,
    stop: &StopFlag<'_>,
) -> PyResult<Agent> {
    let shape = (n_rows, spec.num_actions);
    let masks = match spec.algorithm {
        // They draw actions without looking at values: to plan with what was not tried, and to start an episode.
        AnyAlgorithm::DynaQPlus { .. } | AnyAlgorithm::MonteCarloEs { .. } if spec.action_masks.is_none() => {
            spec.initial_q.masks(n_rows * spec.num_actions, spec.num_actions)?
        }
        _ => spec.action_masks.build(shape, n_active, stop)?,
    };
    Ok(Agent {
        table: spec.initial_q.table((0, spec.algorithm.n_tables()), shape, rng, stop)?,
        policy: match spec.policy {
            PolicySpec::Ucb { confidence, ties } => {
                AnyPolicy::Ucb(Ucb::new(confidence, ties, shape, stop).map_err(allocation)?)
            }
            other => {
                let has_masks = spec.initial_q.has_masked_actions() || !spec.action_masks.is_none();
                policy(other, spec.episodes, spec.num_actions, has_masks)
            }
        },
        learning_rate: learning_rate(spec, n_rows * spec.num_actions, n_active, stop).map_err(allocation)?,
        discount: spec.discount,
        terminal_update: spec.terminal_update,
        masks,
    })
}

/// The behaviour policy of a run of so many episodes, whichever it is, except for UCB, which counts visits of a table.
pub(super) fn policy(spec: PolicySpec, episodes: u64, num_actions: usize, has_masks: bool) -> AnyPolicy {
    match spec {
        PolicySpec::EpsilonGreedy { epsilon, ties } if has_masks => {
            AnyPolicy::MaskedEpsilonGreedy { epsilon: epsilon.build(episodes), ties }
        }
        PolicySpec::EpsilonGreedy { epsilon, ties } => {
            AnyPolicy::EpsilonGreedy { epsilon: epsilon.build(episodes), ties }
        }
        PolicySpec::Softmax { temperature } => AnyPolicy::softmax(temperature, num_actions),
        PolicySpec::Ucb { .. } => unreachable!("generic_agent makes it"),
    }
}

fn learning_rate(
    spec: &RunSpec,
    weights: usize,
    n_active: usize,
    stop: &StopFlag<'_>,
) -> Result<LearningRate, AllocationError> {
    match spec.learning_rate {
        LearningRateSpec::Schedule(schedule) => Ok(LearningRate::scheduled(schedule.build(spec.episodes), n_active)),
        LearningRateSpec::Visits { value, minimum } => {
            LearningRate::by_visit_count(value, minimum, weights, n_active, stop)
        }
    }
}
