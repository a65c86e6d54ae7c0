//! Runs compiled for their types: one-step learners on a grid, with `N` actions known at compile time.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::batch::BatchedRun;
use qtab_core::learners::{Agent, AnyAlgorithm, ExpectedSarsa, QLearning, Sarsa, TdLearner, UpdateRule};
use qtab_core::policies::{EpsilonGreedy, Policy, TieBreaking};
use qtab_core::random::Pcg64;
use qtab_core::schedules::{Schedule, StepSize};
use qtab_core::tasks::{NativeTask, VisitCounter};
use qtab_core::{Env, Features, StopFlag, Trainer};

use super::factory::{Batching, advance_lanes, factory};
use super::path::{PlainSpec, RunPath};
use super::prediction::predicting;
use super::{Run, RunFactory, generic};
use crate::convert::Seed;
use crate::error::allocation;
use crate::rng::{agent_pcg64, environment_rng};
use crate::spec::{LearningRateSpec, PolicySpec, RunSpec, ScheduleSpec};

/// A run of an update rule `U` with a policy `P` and a learning rate `A`.
pub(super) type OneStepRun<E, F, U, P, A, const N: usize> =
    Trainer<NativeTask<E, F>, TdLearner<U, Agent<N, P, A>>, Pcg64>;

/// The functions that advance one-step learners together, by the types of their update rule and learning rate.
pub(crate) struct OneStepBatching<E, F, P, const N: usize>
where
    E: Env<Action = usize>,
    F: Features<E::Observation>,
{
    q_learning: Batching<OneStepRun<E, F, QLearning, P, f64, N>>,
    scheduled_q_learning: Batching<OneStepRun<E, F, QLearning, P, Schedule, N>>,
    sarsa: Batching<OneStepRun<E, F, Sarsa, P, Schedule, N>>,
    expected_sarsa: Batching<OneStepRun<E, F, ExpectedSarsa, P, Schedule, N>>,
}

impl<E, F, P, const N: usize> OneStepBatching<E, F, P, N>
where
    E: Env<Action = usize>,
    F: Features<E::Observation>,
{
    /// Advances each run separately.
    pub(crate) fn one_by_one() -> Self {
        Self { q_learning: None, scheduled_q_learning: None, sarsa: None, expected_sarsa: None }
    }
}

impl<E, F, P, const N: usize> OneStepBatching<E, F, P, N>
where
    E: Env<Action = usize>,
    F: Features<E::Observation>,
    OneStepRun<E, F, QLearning, P, f64, N>: Run + BatchedRun,
    OneStepRun<E, F, QLearning, P, Schedule, N>: Run + BatchedRun,
    OneStepRun<E, F, Sarsa, P, Schedule, N>: Run + BatchedRun,
    OneStepRun<E, F, ExpectedSarsa, P, Schedule, N>: Run + BatchedRun,
{
    /// Advances several runs in the processor's vector registers.
    pub(crate) fn in_lanes() -> Self {
        Self {
            q_learning: Some(advance_lanes),
            scheduled_q_learning: Some(advance_lanes),
            sarsa: Some(advance_lanes),
            expected_sarsa: Some(advance_lanes),
        }
    }
}

/// Runs compiled for their types if the spec asks for a one-step learner with `N` actions, otherwise generic runs.
pub(crate) fn specialized<E, F, const N: usize>(
    env: E,
    features: F,
    spec: &Arc<RunSpec>,
    batching: OneStepBatching<E, F, EpsilonGreedy, N>,
) -> PyResult<Box<dyn RunFactory>>
where
    E: Env<Action = usize, State: Send> + Clone + Send + Sync + 'static,
    F: Features<E::Observation, Active = [u32; 1]> + Clone + Send + Sync + 'static,
{
    let plain = match RunPath::of(spec) {
        RunPath::PlainPrediction(prediction) => return Ok(predicting(env, features, spec, &prediction)),
        RunPath::Plain(plain) if fits(&env, &plain, N) => plain,
        _ => return generic(env, features, spec),
    };
    let LearningRateSpec::Schedule(learning_rate) = plain.learning_rate else {
        return generic(env, features, spec);
    };
    let one_step =
        matches!(plain.algorithm, AnyAlgorithm::QLearning | AnyAlgorithm::Sarsa | AnyAlgorithm::ExpectedSarsa);
    if !one_step || matches!(plain.policy, PolicySpec::Ucb { .. }) {
        return generic(env, features, spec);
    }
    let epsilon_greedy = plain_epsilon_greedy(&plain);
    let has_masks = plain.initial_q.has_masked_actions();
    let any_policy = plain.policy.build(plain.episodes, (0, N), has_masks, &StopFlag::new()).map_err(allocation)?;
    let builder = Builder::<E, F, N> { env, features, spec: plain };
    Ok(match epsilon_greedy {
        Some(epsilon_greedy) => builder.factory(epsilon_greedy, learning_rate, batching),
        None => builder.factory(any_policy, learning_rate, OneStepBatching::one_by_one()),
    })
}

/// Whether the spec and its environment have `num_actions` actions, and updates bootstrap at the time limit.
pub(super) fn fits(env: &impl Env, spec: &PlainSpec, num_actions: usize) -> bool {
    spec.num_actions == num_actions && env.num_actions() == num_actions && !spec.terminate_on_truncation
}

/// The policy of a spec, if it is ε-greedy as in the article, or with a constant ε.
pub(super) fn plain_epsilon_greedy(spec: &PlainSpec) -> Option<EpsilonGreedy> {
    let PolicySpec::EpsilonGreedy { epsilon, ties: TieBreaking::First } = spec.policy else { return None };
    let (value, minimum) = match epsilon {
        ScheduleSpec::Linear { value, minimum, warm_up: 0 } => (value, minimum),
        ScheduleSpec::Constant { value } => (value, value),
        _ => return None,
    };
    (!spec.initial_q.has_masked_actions()).then(|| EpsilonGreedy::linear(value, minimum, spec.episodes))
}

/// Builds the runs of a spec, once the types of the policy, the learning rate and the update rule are chosen.
pub(super) struct Builder<E, F, const N: usize> {
    pub(super) env: E,
    pub(super) features: F,
    pub(super) spec: PlainSpec,
}

impl<E, F, const N: usize> Builder<E, F, N>
where
    E: Env<Action = usize, State: Send> + Clone + Send + Sync + 'static,
    F: Features<E::Observation, Active = [u32; 1]> + Clone + Send + Sync + 'static,
{
    fn factory<P>(
        self,
        policy: P,
        learning_rate: ScheduleSpec,
        batching: OneStepBatching<E, F, P, N>,
    ) -> Box<dyn RunFactory>
    where
        P: Policy + Clone + Send + Sync + 'static,
    {
        let schedule = learning_rate.build(self.spec.episodes);
        match (self.spec.algorithm, learning_rate) {
            (AnyAlgorithm::Sarsa, _) => self.with_rule(Sarsa, policy, schedule, batching.sarsa),
            (AnyAlgorithm::ExpectedSarsa, _) => {
                self.with_rule(ExpectedSarsa, policy, schedule, batching.expected_sarsa)
            }
            (_, ScheduleSpec::Constant { value }) => self.with_rule(QLearning, policy, value, batching.q_learning),
            _ => self.with_rule(QLearning, policy, schedule, batching.scheduled_q_learning),
        }
    }
}

impl<E, F, const N: usize> Builder<E, F, N>
where
    E: Env<Action = usize, State: Send> + Clone + Send + Sync + 'static,
    F: Features<E::Observation, Active: Send> + Clone + Send + Sync + 'static,
{
    pub(super) fn with_rule<U, P, A>(
        self,
        rule: U,
        policy: P,
        learning_rate: A,
        batching: Batching<OneStepRun<E, F, U, P, A, N>>,
    ) -> Box<dyn RunFactory>
    where
        U: UpdateRule<F::Active, Agent<N, P, A>> + Clone + Send + Sync + 'static,
        P: Policy + Clone + Send + Sync + 'static,
        A: StepSize + Clone + Send + Sync + 'static,
    {
        let Self { env, features, spec } = self;
        let PlainSpec {
            max_episode_steps,
            discount,
            initial_q,
            terminal_update,
            count_visits,
            // `fits` excludes runs that do not bootstrap.
            terminate_on_truncation: _,
            // The arguments and `N` were built from these.
            num_actions: _,
            algorithm: _,
            policy: _,
            learning_rate: _,
            episodes: _,
        } = spec;
        let parts = move |seed: &Seed, stop: &StopFlag<'_>| {
            let mut rng = agent_pcg64(seed);
            let agent = Agent {
                table: initial_q.table((0, 1), (features.len(), N), &mut rng, stop)?,
                policy: policy.clone(),
                learning_rate: learning_rate.clone(),
                discount,
                terminal_update,
                masks: None,
            };
            let task = NativeTask::new(env.clone(), features.clone(), Some(max_episode_steps), environment_rng(seed));
            let learner = TdLearner { agent, rule: rule.clone() };
            PyResult::Ok((task, learner, rng))
        };
        // Counting is a separate type, so that runs that do not count pay nothing for it.
        if count_visits {
            let build = move |seed: &Seed, stop: &StopFlag<'_>| {
                let (task, learner, rng) = parts(seed, stop)?;
                let task =
                    VisitCounter::new(task, learner.agent.table.values().len() / N, N, stop).map_err(allocation)?;
                Ok(Trainer::new(task, learner, rng))
            };
            return factory(build, None);
        }
        let build = move |seed: &Seed, stop: &StopFlag<'_>| {
            let (task, learner, rng) = parts(seed, stop)?;
            Ok(Trainer::new(task, learner, rng))
        };
        factory(build, batching)
    }
}
