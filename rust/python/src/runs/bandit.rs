//! Runs of action-value methods on a bandit, compiled for their policy and learning rate.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::learners::{Agent, AnyAlgorithm, LearnerVisitor, QLearning, TdLearner};
use qtab_core::policies::{Policy, SingleStateEpsilonGreedy, SingleStateUcb, Ucb};
use qtab_core::random::Pcg64;
use qtab_core::schedules::{StepSize, VisitRate};
use qtab_core::tasks::{KArmedBandit, Testbed};
use qtab_core::{QTable, StopFlag};

use super::factory::{Batching, Factory};
use super::pending::PendingRun;
use super::{AnyRecordings, RunFactory, boxed_factory};
use crate::convert::Seed;
use crate::error::{allocation, invalid};
use crate::rng::{BitGenerator, agent_pcg64, environment_rng};
use crate::spec::{LearningRateSpec, PolicySpec, RunSpec};

/// The number of actions in the book, with which the loops over actions are unrolled.
const BOOK_ACTIONS: usize = 10;

/// Runs on a bandit: compiled for their types where that is possible, generic otherwise.
pub(crate) fn bandit_runs(testbed: Testbed, spec: &Arc<RunSpec>, record: usize) -> Box<dyn RunFactory> {
    let new_task = move |seed: &Seed| KArmedBandit::new(testbed, environment_rng(seed));
    if record > 0 || !is_specialized(spec) {
        return boxed_factory(new_task, (1, 1), spec, record, AnyRecordings::Native);
    }
    let spec = Arc::clone(spec);
    let build = move |seed: &Seed, stop: &StopFlag<'_>| {
        let run = with_learner(&spec, seed, stop, |rng| PendingRun { task: new_task(seed), rng })?;
        Ok((run, AnyRecordings::None))
    };
    Box::new(Factory { build, batching: Batching::one_by_one() })
}

/// Whether [`with_learner`] has the learner of a spec.
pub(super) fn is_specialized(spec: &RunSpec) -> bool {
    let policy = match spec.policy {
        PolicySpec::EpsilonGreedy { .. } => true,
        PolicySpec::Ucb { confidence, .. } => confidence >= 0.0,
        PolicySpec::Softmax { .. } => false,
    };
    let all_actions = !spec.initial_q.has_masked_actions() && spec.action_masks.is_none();
    policy
        && all_actions
        && matches!(spec.algorithm, AnyAlgorithm::QLearning)
        && spec.bit_generator == BitGenerator::Pcg64
        && spec.count_bonus == 0.0
        && !spec.count_visits
}

/// Passes the learner of a spec to the visitor that `new_visitor` makes of the agent's generator, which has drawn the table.
pub(super) fn with_learner<V: LearnerVisitor<[u32; 1]>>(
    spec: &RunSpec,
    seed: &Seed,
    stop: &StopFlag<'_>,
    new_visitor: impl FnOnce(Pcg64) -> V,
) -> PyResult<V::Output> {
    let mut rng = agent_pcg64(seed);
    let shape = (1, spec.num_actions);
    if spec.num_actions == BOOK_ACTIONS {
        let table = spec.initial_q.table::<BOOK_ACTIONS>((0, 1), shape, &mut rng, stop)?;
        with_table(spec, table, stop, new_visitor(rng))
    } else {
        let table = spec.initial_q.table::<0>((0, 1), shape, &mut rng, stop)?;
        with_table(spec, table, stop, new_visitor(rng))
    }
}

fn with_table<V: LearnerVisitor<[u32; 1]>, const N: usize>(
    spec: &RunSpec,
    table: QTable<N>,
    stop: &StopFlag<'_>,
    visitor: V,
) -> PyResult<V::Output> {
    match spec.policy {
        PolicySpec::EpsilonGreedy { epsilon, ties } => {
            let policy = SingleStateEpsilonGreedy::new(epsilon.build(spec.episodes), ties);
            with_policy(spec, table, policy, stop, visitor)
        }
        PolicySpec::Ucb { confidence, ties } => {
            let ucb = Ucb::new(confidence, ties, (1, spec.num_actions), stop).map_err(allocation)?;
            with_policy(spec, table, SingleStateUcb::new(ucb), stop, visitor)
        }
        PolicySpec::Softmax { .. } => Err(invalid("policy", "'epsilon_greedy' or 'ucb'", "'softmax'")),
    }
}

fn with_policy<V, P, const N: usize>(
    spec: &RunSpec,
    table: QTable<N>,
    policy: P,
    stop: &StopFlag<'_>,
    visitor: V,
) -> PyResult<V::Output>
where
    V: LearnerVisitor<[u32; 1]>,
    P: Policy + Send + 'static,
{
    match spec.learning_rate {
        LearningRateSpec::Schedule(schedule) => {
            Ok(with_learning_rate(spec, table, policy, schedule.build(spec.episodes), visitor))
        }
        LearningRateSpec::Visits { value, minimum } => {
            let rate = VisitRate::new(value, minimum, spec.num_actions, stop).map_err(allocation)?;
            Ok(with_learning_rate(spec, table, policy, rate, visitor))
        }
    }
}

fn with_learning_rate<V, P, A, const N: usize>(
    spec: &RunSpec,
    table: QTable<N>,
    policy: P,
    learning_rate: A,
    visitor: V,
) -> V::Output
where
    V: LearnerVisitor<[u32; 1]>,
    P: Policy + Send + 'static,
    A: StepSize + Send + 'static,
{
    let RunSpec { discount, terminal_update, .. } = *spec;
    let agent = Agent { table, policy, learning_rate, discount, terminal_update, masks: None };
    visitor.visit(TdLearner { agent, rule: QLearning })
}
