//! A checked way to build a run of any algorithm.

mod build;
mod checks;
#[cfg(test)]
mod saving_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod weighted_tests;

use super::Trainer;
use crate::envs::Env;
use crate::features::Features;
use crate::learners::{AnyAlgorithm, AnyLearner};
use crate::policies::TieBreaking;
use crate::q_table::{QTable, TerminalUpdate};
use crate::random::AgentRng;
use crate::settings::{LearningRateSpec, PolicySpec, ScheduleSpec};
use crate::tasks::NativeTask;

/// A run of any algorithm in an environment `E` with features `F`: what [`Trainer::builder`] builds.
pub type AnyTrainer<E, F> =
    Trainer<NativeTask<E, F>, AnyLearner<<F as Features<<E as Env>::Observation>>::Active>, AgentRng>;

/// The initial values of the tables.
#[derive(Clone, Debug, PartialEq)]
enum InitialValues {
    Constant(f64),
    Uniform { low: f64, high: f64 },
    Table(QTable),
}

/// The settings of a run, which [`build`](Self::build) checks together. Every setting but the environment and its
/// features has a default.
///
/// | setting | default |
/// |---|---|
/// | [`algorithm`](Self::algorithm) | [`AnyAlgorithm::QLearning`] |
/// | [`learning_rate`](Self::learning_rate) | 0.1 |
/// | [`discount`](Self::discount) | 0.99 |
/// | [`policy`](Self::policy), [`epsilon`](Self::epsilon) | ε-greedy with ε = 0.1; ties are broken at random |
/// | [`initial_value`](Self::initial_value), [`initial_uniform`](Self::initial_uniform), [`initial_table`](Self::initial_table) | 0 |
/// | [`max_episode_steps`](Self::max_episode_steps) | no limit |
/// | [`terminal_update`](Self::terminal_update) | [`TerminalUpdate::Target`] |
/// | [`episodes`](Self::episodes) | unknown, which only linear schedules do not allow |
/// | [`seed`](Self::seed) | 0 |
///
/// With the same settings and seed, a run computes the same numbers as `qtab.train` in Python, to the bit.
///
/// ```
/// use qtab_core::envs::toy_text::FrozenLake;
/// use qtab_core::features::Identity;
/// use qtab_core::settings::ScheduleSpec;
/// use qtab_core::Trainer;
///
/// let mut trainer = Trainer::builder(FrozenLake::default(), Identity(16))
///     .max_episode_steps(100)
///     .episodes(2000)
///     .epsilon(ScheduleSpec::linear(1.0, 0.05))
///     .build()?;
/// trainer.train(2000)?;
/// assert!(trainer.evaluate(100, 1)?.mean_return(100) > 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[must_use = "a run is made by `build`"]
pub struct TrainerBuilder<E, F> {
    env: E,
    features: F,
    max_episode_steps: Option<u64>,
    algorithm: AnyAlgorithm,
    policy: PolicySpec,
    learning_rate: LearningRateSpec,
    discount: f64,
    initial_values: InitialValues,
    terminal_update: TerminalUpdate,
    episodes: Option<u64>,
    seed: u64,
}

impl<E, F> AnyTrainer<E, F>
where
    E: Env<Action = usize>,
    F: Features<E::Observation>,
{
    /// The settings of a run in this environment, whose observations these features map to rows.
    pub fn builder(env: E, features: F) -> TrainerBuilder<E, F> {
        let epsilon = ScheduleSpec::constant(0.1);
        TrainerBuilder {
            env,
            features,
            max_episode_steps: None,
            algorithm: AnyAlgorithm::QLearning,
            policy: PolicySpec::EpsilonGreedy { epsilon, ties: TieBreaking::Random },
            learning_rate: LearningRateSpec::from(0.1),
            discount: 0.99,
            initial_values: InitialValues::Constant(0.0),
            terminal_update: TerminalUpdate::Target,
            episodes: None,
            seed: 0,
        }
    }
}

impl<E, F> TrainerBuilder<E, F> {
    /// The time limit of an episode, in steps. Monte Carlo methods need one, and so does
    /// [`Trainer::evaluate`].
    pub fn max_episode_steps(self, steps: u64) -> Self {
        Self { max_episode_steps: Some(steps), ..self }
    }

    /// The algorithm with its options. The time limit in a Monte Carlo method is replaced by that of the run.
    pub fn algorithm(self, algorithm: AnyAlgorithm) -> Self {
        Self { algorithm, ..self }
    }

    /// The policy with its options.
    pub fn policy(self, policy: PolicySpec) -> Self {
        Self { policy, ..self }
    }

    /// The ε-greedy policy with this exploration rate, a number or a schedule in [0, 1]. Ties are broken at random.
    pub fn epsilon(self, epsilon: impl Into<ScheduleSpec>) -> Self {
        self.policy(PolicySpec::EpsilonGreedy { epsilon: epsilon.into(), ties: TieBreaking::Random })
    }

    /// The learning rate α, a number or a schedule in [0, 1]. Several active rows share it: each moves by α divided by
    /// their number, and α may then be up to 2. Algorithms that learn preferences take any α.
    pub fn learning_rate(self, learning_rate: impl Into<LearningRateSpec>) -> Self {
        Self { learning_rate: learning_rate.into(), ..self }
    }

    /// The discount γ, in [0, 1].
    pub fn discount(self, discount: f64) -> Self {
        Self { discount, ..self }
    }

    /// One value for all entries of the tables, except for a critic's, which begin at 0.
    pub fn initial_value(self, value: f64) -> Self {
        Self { initial_values: InitialValues::Constant(value), ..self }
    }

    /// Random values for the tables, uniform in [`low`, `high`).
    pub fn initial_uniform(self, low: f64, high: f64) -> Self {
        Self { initial_values: InitialValues::Uniform { low, high }, ..self }
    }

    /// The table to begin with: as many rows as the features have, and as many actions as the environment has.
    pub fn initial_table(self, table: QTable) -> Self {
        Self { initial_values: InitialValues::Table(table), ..self }
    }

    /// The update at a terminal state.
    pub fn terminal_update(self, update: TerminalUpdate) -> Self {
        Self { terminal_update: update, ..self }
    }

    /// The number of episodes of the whole run, over which linear schedules fall.
    pub fn episodes(self, episodes: u64) -> Self {
        Self { episodes: Some(episodes), ..self }
    }

    /// The seed of the environment and, independent of it, of the agent.
    pub fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }
}
