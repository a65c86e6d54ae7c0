//! Runs on a bandit, compiled for their policy and learning rate where that is possible.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::learners::{Agent, AnyAlgorithm, GradientBandit, QLearning, TdLearner, UpdateRule};
use qtab_core::policies::{Policy, SingleStateEpsilonGreedy, SingleStateUcb, Ucb};
use qtab_core::random::Pcg64;
use qtab_core::schedules::{LearningRate, StepSize, VisitRate};
use qtab_core::tasks::{KArmedBandit, Testbed};
use qtab_core::{QTable, StopFlag, Trainer};

use super::agent::policy;
use super::factory::{Batching, Factory};
use super::generic::boxed_run;
use super::path::{PlainSpec, RunPath};
use super::{AnyRecordings, Run, RunFactory};
use crate::convert::Seed;
use crate::error::allocation;
use crate::rng::{agent_pcg64, environment_rng};
use crate::spec::{LearningRateSpec, PolicySpec, RunSpec};

/// The number of actions in the book, with which the loops over actions are unrolled.
const BOOK_ACTIONS: usize = 10;

/// Runs on a bandit.
pub(crate) fn bandit_runs(testbed: Testbed, spec: &Arc<RunSpec>) -> Box<dyn RunFactory> {
    let (spec, plain) = (Arc::clone(spec), compiled(spec));
    let build = move |seed: &Seed, stop: &StopFlag<'_>| {
        let task = KArmedBandit::new(testbed, environment_rng(seed));
        match &plain {
            Some(plain) => Ok((compiled_run(task, plain, seed, stop)?, AnyRecordings::None)),
            None => boxed_run(task, (1, 1), seed, &spec, stop, AnyRecordings::Native),
        }
    };
    Box::new(Factory { build, batching: Batching::one_by_one() })
}

/// The same runs, which also record whether the optimal action was taken.
pub(crate) fn testbed_runs(testbed: Testbed, spec: &Arc<RunSpec>) -> Box<dyn RunFactory> {
    let (spec, plain) = (Arc::clone(spec), compiled(spec));
    let build = move |seed: &Seed, stop: &StopFlag<'_>| {
        let task = KArmedBandit::new(testbed, environment_rng(seed));
        let (task, optimal) = task.recording(spec.episodes as usize).map_err(allocation)?;
        let run = match &plain {
            Some(plain) => compiled_run(task, plain, seed, stop)?,
            None => boxed_run(task, (1, 1), seed, &spec, stop, AnyRecordings::Native)?.0,
        };
        Ok((run, AnyRecordings::OptimalActions(optimal)))
    };
    Box::new(Factory { build, batching: Batching::one_by_one() })
}

/// The spec, if [`compiled_run`] supports it.
fn compiled(spec: &RunSpec) -> Option<PlainSpec> {
    let RunPath::Plain(plain) = RunPath::of(spec) else { return None };
    let is_compiled = match (plain.algorithm, plain.policy, plain.learning_rate) {
        (AnyAlgorithm::QLearning, PolicySpec::EpsilonGreedy { .. }, _)
        | (AnyAlgorithm::GradientBandit { .. }, PolicySpec::Softmax { .. }, LearningRateSpec::Schedule(_)) => true,
        (AnyAlgorithm::QLearning, PolicySpec::Ucb { confidence, .. }, _) => confidence >= 0.0,
        _ => false,
    };
    (is_compiled && !plain.initial_q.has_masked_actions() && !plain.count_visits).then_some(plain)
}

/// A run in which each episode is a step in the same state.
fn compiled_run<const RECORDS: bool>(
    task: KArmedBandit<RECORDS>,
    spec: &PlainSpec,
    seed: &Seed,
    stop: &StopFlag<'_>,
) -> PyResult<Box<dyn Run>> {
    let mut rng = agent_pcg64(seed);
    let shape = (1, spec.num_actions);
    if let (AnyAlgorithm::GradientBandit { baseline }, LearningRateSpec::Schedule(schedule)) =
        (spec.algorithm, spec.learning_rate)
    {
        let table = spec.initial_q.table::<0>((0, 1), shape, &mut rng, stop)?;
        let policy = policy(spec.policy, spec.episodes, spec.num_actions, false);
        let learning_rate = LearningRate::scheduled(schedule.build(spec.episodes), 1);
        let rule = GradientBandit::new(baseline, 1, stop).map_err(allocation)?;
        return Ok(with_rule(task, table, policy, learning_rate, rule, (rng, spec)));
    }
    if spec.num_actions == BOOK_ACTIONS {
        let table = spec.initial_q.table::<BOOK_ACTIONS>((0, 1), shape, &mut rng, stop)?;
        with_table(task, table, rng, spec, stop)
    } else {
        let table = spec.initial_q.table::<0>((0, 1), shape, &mut rng, stop)?;
        with_table(task, table, rng, spec, stop)
    }
}

fn with_table<const RECORDS: bool, const N: usize>(
    task: KArmedBandit<RECORDS>,
    table: QTable<N>,
    rng: Pcg64,
    spec: &PlainSpec,
    stop: &StopFlag<'_>,
) -> PyResult<Box<dyn Run>> {
    match spec.policy {
        PolicySpec::EpsilonGreedy { epsilon, ties } => {
            let policy = SingleStateEpsilonGreedy::new(epsilon.build(spec.episodes), ties);
            with_policy(task, table, policy, rng, spec, stop)
        }
        PolicySpec::Ucb { confidence, ties } => {
            let ucb = Ucb::new(confidence, ties, (1, spec.num_actions), stop).map_err(allocation)?;
            with_policy(task, table, SingleStateUcb::new(ucb), rng, spec, stop)
        }
        PolicySpec::Softmax { .. } => unreachable!("it is not compiled"),
    }
}

fn with_policy<P: Policy + Send + 'static, const RECORDS: bool, const N: usize>(
    task: KArmedBandit<RECORDS>,
    table: QTable<N>,
    policy: P,
    rng: Pcg64,
    spec: &PlainSpec,
    stop: &StopFlag<'_>,
) -> PyResult<Box<dyn Run>> {
    match spec.learning_rate {
        LearningRateSpec::Schedule(schedule) => {
            Ok(with_rule(task, table, policy, schedule.build(spec.episodes), QLearning, (rng, spec)))
        }
        LearningRateSpec::Visits { value, minimum } => {
            let rate = VisitRate::new(value, minimum, spec.num_actions, stop).map_err(allocation)?;
            Ok(with_rule(task, table, policy, rate, QLearning, (rng, spec)))
        }
    }
}

fn with_rule<P, A, U, const RECORDS: bool, const N: usize>(
    task: KArmedBandit<RECORDS>,
    table: QTable<N>,
    policy: P,
    learning_rate: A,
    rule: U,
    (rng, spec): (Pcg64, &PlainSpec),
) -> Box<dyn Run>
where
    P: Policy + Send + 'static,
    A: StepSize + Send + 'static,
    U: UpdateRule<[u32; 1], Agent<N, P, A>> + Send + 'static,
{
    let PlainSpec {
        discount,
        terminal_update,
        // The arguments were built from these.
        num_actions: _,
        algorithm: _,
        policy: _,
        learning_rate: _,
        initial_q: _,
        episodes: _,
        // An episode is a single step, which ends it whatever its limit.
        max_episode_steps: _,
        terminate_on_truncation: _,
        // `compiled` leaves out the runs that count visits.
        count_visits: _,
    } = *spec;
    let agent = Agent { table, policy, learning_rate, discount, terminal_update, masks: None };
    Box::new(Trainer::new(task, TdLearner { agent, rule }, rng))
}
