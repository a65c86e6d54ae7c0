//! Runs that are compiled for their types: one-step learners on a grid, with `N` actions known at compile time.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::batch::BatchedRun;
use qtab_core::learners::{Agent, AnyAlgorithm, ExpectedSarsa, QLearning, Sarsa, TdLearner, UpdateRule};
use qtab_core::policies::{EpsilonGreedy, Policy, TieBreaking};
use qtab_core::random::Pcg64;
use qtab_core::schedules::{Schedule, StepSize};
use qtab_core::tasks::{NativeTask, VisitCounter};
use qtab_core::{Env, Features, StopFlag, Trainer};

use super::agent::policy;
use super::factory::{Batching, Factory};
use super::prediction::predicting;
use super::{AnyRecordings, Run, RunFactory, generic};
use crate::convert::Seed;
use crate::error::allocation;
use crate::rng::{BitGenerator, agent_pcg64, environment_rng};
use crate::spec::{LearningRateSpec, PolicySpec, RunSpec, ScheduleSpec};

/// A run of an update rule `U` with a policy `P` and a learning rate `A`.
type OneStepRun<E, F, U, P, A, const N: usize> = Trainer<NativeTask<E, F>, TdLearner<U, Agent<N, P, A>>, Pcg64>;

/// How Q-learning runs advance together, by the type of their learning rate.
pub(crate) struct QLearningBatching<E, F, P, const N: usize>
where
    E: Env<Action = usize>,
    F: Features<E::Observation>,
{
    constant: Batching<OneStepRun<E, F, QLearning, P, f64, N>>,
    scheduled: Batching<OneStepRun<E, F, QLearning, P, Schedule, N>>,
}

impl<E, F, P, const N: usize> QLearningBatching<E, F, P, N>
where
    E: Env<Action = usize>,
    F: Features<E::Observation>,
    OneStepRun<E, F, QLearning, P, f64, N>: Run,
    OneStepRun<E, F, QLearning, P, Schedule, N>: Run,
{
    /// Each run by itself.
    pub(crate) fn one_by_one() -> Self {
        Self { constant: Batching::one_by_one(), scheduled: Batching::one_by_one() }
    }
}

impl<E, F, P, const N: usize> QLearningBatching<E, F, P, N>
where
    E: Env<Action = usize>,
    F: Features<E::Observation>,
    OneStepRun<E, F, QLearning, P, f64, N>: Run + BatchedRun,
    OneStepRun<E, F, QLearning, P, Schedule, N>: Run + BatchedRun,
{
    /// Several runs in the processor's vector registers.
    pub(crate) fn in_lanes() -> Self {
        Self { constant: Batching::in_lanes(), scheduled: Batching::in_lanes() }
    }
}

/// Runs compiled for their types where the spec asks for a one-step learner of `N` actions; the generic ones otherwise.
pub(crate) fn specialized<E, F, const N: usize>(
    env: E,
    features: F,
    spec: &Arc<RunSpec>,
    record: usize,
    batching: QLearningBatching<E, F, EpsilonGreedy, N>,
) -> PyResult<Box<dyn RunFactory>>
where
    E: Env<Action = usize, State: Send> + Clone + Send + Sync + 'static,
    F: Features<E::Observation, Active = [u32; 1]> + Clone + Send + Sync + 'static,
{
    if let Some(prediction) = &spec.prediction {
        if super::prediction::is_specialized(spec, record) {
            return Ok(predicting(env, features, spec, prediction));
        }
        return generic(env, features, spec, record);
    }
    let LearningRateSpec::Schedule(learning_rate) = spec.learning_rate else {
        return generic(env, features, spec, record);
    };
    let one_step =
        matches!(spec.algorithm, AnyAlgorithm::QLearning | AnyAlgorithm::Sarsa | AnyAlgorithm::ExpectedSarsa);
    let fits = spec.num_actions == N && env.num_actions() == N && spec.bit_generator == BitGenerator::Pcg64;
    let counts = matches!(spec.policy, PolicySpec::Ucb { .. }) || spec.count_bonus != 0.0;
    if !one_step || !fits || counts || !spec.action_masks.is_none() || spec.terminate_on_truncation || record > 0 {
        return generic(env, features, spec, record);
    }
    let builder = Builder::<E, F, N> { env, features, spec: Arc::clone(spec) };
    Ok(match spec.policy {
        PolicySpec::EpsilonGreedy {
            epsilon: ScheduleSpec::Linear { value, minimum, warm_up: 0 },
            ties: TieBreaking::First,
        } if !spec.initial_q.has_masked_actions() => {
            builder.factory(EpsilonGreedy::linear(value, minimum, spec.episodes), learning_rate, batching)
        }
        _ => builder.factory(policy(spec), learning_rate, QLearningBatching::one_by_one()),
    })
}

/// Builds the runs of a spec, once the types of the policy, the learning rate and the update rule are chosen.
struct Builder<E, F, const N: usize> {
    env: E,
    features: F,
    spec: Arc<RunSpec>,
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
        batching: QLearningBatching<E, F, P, N>,
    ) -> Box<dyn RunFactory>
    where
        P: Policy + Clone + Send + Sync + 'static,
    {
        let schedule = learning_rate.build(self.spec.episodes);
        match (self.spec.algorithm, learning_rate) {
            (AnyAlgorithm::Sarsa, _) => self.with_rule(Sarsa, policy, schedule, Batching::one_by_one()),
            (AnyAlgorithm::ExpectedSarsa, _) => self.with_rule(ExpectedSarsa, policy, schedule, Batching::one_by_one()),
            (_, ScheduleSpec::Constant { value }) => self.with_rule(QLearning, policy, value, batching.constant),
            _ => self.with_rule(QLearning, policy, schedule, batching.scheduled),
        }
    }

    fn with_rule<U, P, A>(
        self,
        rule: U,
        policy: P,
        learning_rate: A,
        batching: Batching<OneStepRun<E, F, U, P, A, N>>,
    ) -> Box<dyn RunFactory>
    where
        U: UpdateRule<[u32; 1], Agent<N, P, A>> + Clone + Send + Sync + 'static,
        P: Policy + Clone + Send + Sync + 'static,
        A: StepSize + Clone + Send + Sync + 'static,
    {
        let Self { env, features, spec } = self;
        let count_visits = spec.count_visits;
        let parts = move |seed: &Seed, stop: &StopFlag<'_>| {
            let mut rng = agent_pcg64(seed);
            let agent = Agent {
                table: spec.initial_q.table((0, 1), (features.len(), N), &mut rng, stop)?,
                policy: policy.clone(),
                learning_rate: learning_rate.clone(),
                discount: spec.discount,
                terminal_update: spec.terminal_update,
                masks: None,
            };
            let task =
                NativeTask::new(env.clone(), features.clone(), Some(spec.max_episode_steps), environment_rng(seed));
            let learner = TdLearner { agent, rule: rule.clone() };
            PyResult::Ok((task, learner, rng))
        };
        // Counting is compiled into the steps of a type of its own: a run that does not count pays nothing for it.
        if count_visits {
            let build = move |seed: &Seed, stop: &StopFlag<'_>| {
                let (task, learner, rng) = parts(seed, stop)?;
                let task =
                    VisitCounter::new(task, learner.agent.table.values().len() / N, N, stop).map_err(allocation)?;
                Ok((Trainer::new(task, learner, rng), AnyRecordings::None))
            };
            return Box::new(Factory { build, batching: Batching::one_by_one() });
        }
        let build = move |seed: &Seed, stop: &StopFlag<'_>| {
            let (task, learner, rng) = parts(seed, stop)?;
            Ok((Trainer::new(task, learner, rng), AnyRecordings::None))
        };
        Box::new(Factory { build, batching })
    }
}
