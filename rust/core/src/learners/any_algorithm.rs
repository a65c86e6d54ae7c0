//! An algorithm chosen at run time.

#[cfg(doc)]
use super::{
    ActorCritic, ActorCriticLambda, Critic, DifferentialQLearning, DifferentialSarsa, DoubleQLearning, DynaQ,
    DynaQPlus, ExpectedSarsa, GradientBandit, MonteCarloControl, NStepQSigma, NStepSarsa, NStepTreeBackup,
    OffPolicyMonteCarlo, PrioritizedSweeping, QLearning, Reinforce, Sarsa, SarsaLambda, StochasticModel,
    TrueOnlineSarsaLambda, WatkinsQLambda,
};
use super::{Agent, AnyLearner, LearnerVisitor, TargetPolicy, TraceKind, TraceOptions};
use crate::features::ActiveRows;
use crate::memory::AllocationError;
use crate::{QTable, StopFlag};

/// One of the algorithms with its options.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum AnyAlgorithm {
    /// [`QLearning`]
    QLearning,
    /// [`Sarsa`]
    Sarsa,
    /// [`ExpectedSarsa`]
    ExpectedSarsa,
    /// [`DoubleQLearning`]
    DoubleQLearning,
    /// [`NStepSarsa`]
    NStepSarsa {
        /// The number of rewards in a target, at least 1.
        n_steps: usize,
    },
    /// [`SarsaLambda`]
    SarsaLambda(TraceOptions),
    /// [`TrueOnlineSarsaLambda`]
    TrueOnlineSarsaLambda {
        /// The trace decay λ.
        trace_decay: f64,
        /// Traces at or below this are dropped.
        trace_cutoff: f64,
    },
    /// [`WatkinsQLambda`]
    WatkinsQLambda(TraceOptions),
    /// [`DynaQ`]
    DynaQ {
        /// The number of planning updates after each step.
        planning_steps: u32,
    },
    /// [`DynaQPlus`]
    DynaQPlus {
        /// The number of planning updates after each step.
        planning_steps: u32,
        /// The weight κ of the bonus for actions that have not been tried for a long time.
        time_weight: f64,
    },
    /// [`DynaQ`] with a [`StochasticModel`]
    StochasticDynaQ {
        /// The number of planning updates after each step.
        planning_steps: u32,
    },
    /// [`MonteCarloControl`]
    MonteCarlo {
        /// The maximum number of steps of an episode.
        max_episode_steps: u64,
    },
    /// [`MonteCarloControl`] with exploring starts
    MonteCarloEs {
        /// The maximum number of steps of an episode.
        max_episode_steps: u64,
    },
    /// [`OffPolicyMonteCarlo`]
    OffPolicyMonteCarlo {
        /// The maximum number of steps of an episode.
        max_episode_steps: u64,
        /// The learning rate α, which multiplies W / C.
        learning_rate: f64,
        /// The smallest step size.
        min_learning_rate: f64,
    },
    /// [`NStepTreeBackup`]
    NStepTreeBackup {
        /// The number of rewards in a target, at least 1.
        n_steps: usize,
        /// The target policy.
        target_policy: TargetPolicy,
    },
    /// [`NStepQSigma`]
    NStepQSigma {
        /// The number of rewards in a target, at least 1.
        n_steps: usize,
        /// The degree of sampling σ.
        sigma: f64,
        /// The target policy.
        target_policy: TargetPolicy,
    },
    /// [`PrioritizedSweeping`]
    PrioritizedSweeping {
        /// The maximum number of updates after each step.
        planning_steps: u32,
        /// The threshold θ: errors up to this are not planned.
        priority_threshold: f64,
    },
    /// [`DifferentialSarsa`]
    DifferentialSarsa {
        /// The step size β of the average reward.
        reward_learning_rate: f64,
    },
    /// [`DifferentialQLearning`]
    DifferentialQLearning {
        /// The step size β of the average reward.
        reward_learning_rate: f64,
    },
    /// [`GradientBandit`]
    GradientBandit {
        /// Whether rewards are compared with their average.
        baseline: bool,
    },
    /// [`Reinforce`]
    Reinforce,
    /// [`Reinforce`] with a [`Critic`]
    ReinforceWithBaseline {
        /// The step size αʷ of the state values.
        value_learning_rate: f64,
    },
    /// [`ActorCritic`]
    ActorCritic {
        /// The step size αʷ of the state values.
        value_learning_rate: f64,
    },
    /// [`ActorCriticLambda`]
    ActorCriticLambda {
        /// The step size αʷ of the state values.
        value_learning_rate: f64,
        /// The trace decay λ.
        trace_decay: f64,
    },
}

/// The features with which an algorithm learns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureKinds {
    /// Any features, weighted ones too.
    All,
    /// One or more active rows, whose features are 1.
    Binary,
    /// Exactly one active row for each state.
    SingleRows,
}

impl AnyAlgorithm {
    /// The number of tables that the algorithm learns.
    pub fn n_tables(&self) -> usize {
        if matches!(self, Self::DoubleQLearning) || self.value_learning_rate().is_some() { 2 } else { 1 }
    }

    /// Whether the algorithm needs the probabilities of actions, which not every policy has.
    pub fn needs_probabilities(&self) -> bool {
        matches!(self, Self::OffPolicyMonteCarlo { .. } | Self::NStepTreeBackup { .. } | Self::NStepQSigma { .. })
    }

    /// The features with which the algorithm learns. Every algorithm is listed, so that a new one must decide.
    pub fn feature_kinds(&self) -> FeatureKinds {
        match self {
            Self::QLearning
            | Self::Sarsa
            | Self::ExpectedSarsa
            | Self::DoubleQLearning
            | Self::NStepSarsa { .. }
            | Self::NStepTreeBackup { .. }
            | Self::NStepQSigma { .. }
            | Self::DifferentialSarsa { .. }
            | Self::DifferentialQLearning { .. }
            | Self::TrueOnlineSarsaLambda { .. }
            | Self::Reinforce
            | Self::ReinforceWithBaseline { .. }
            | Self::ActorCritic { .. }
            | Self::ActorCriticLambda { .. } => FeatureKinds::All,
            // Replacing traces set the traces of active features to 1.
            Self::SarsaLambda(options) | Self::WatkinsQLambda(options) => match options.kind {
                TraceKind::Accumulating => FeatureKinds::All,
                TraceKind::Replacing | TraceKind::Clearing => FeatureKinds::Binary,
            },
            Self::DynaQ { .. }
            | Self::DynaQPlus { .. }
            | Self::StochasticDynaQ { .. }
            | Self::MonteCarlo { .. }
            | Self::MonteCarloEs { .. }
            | Self::OffPolicyMonteCarlo { .. }
            | Self::PrioritizedSweeping { .. }
            | Self::GradientBandit { .. } => FeatureKinds::SingleRows,
        }
    }

    /// Whether each state must have exactly one active row: for a model, for a baseline of each state, or for visit
    /// counts.
    pub fn needs_single_rows(&self) -> bool {
        self.feature_kinds() == FeatureKinds::SingleRows
    }

    /// The step size of the state values, stored in the second table; `None` for an algorithm that learns none.
    pub fn value_learning_rate(&self) -> Option<f64> {
        match *self {
            Self::ReinforceWithBaseline { value_learning_rate }
            | Self::ActorCritic { value_learning_rate }
            | Self::ActorCriticLambda { value_learning_rate, .. } => Some(value_learning_rate),
            _ => None,
        }
    }

    /// Whether the table holds preferences, in which case the policy must be the softmax.
    pub fn learns_preferences(&self) -> bool {
        matches!(self, Self::GradientBandit { .. } | Self::Reinforce) || self.value_learning_rate().is_some()
    }

    /// Whether the learning rate can depend on the visits to each weight. It cannot where several weights share the step size
    /// of an update.
    pub(crate) fn takes_rates_by_visits(&self) -> bool {
        !self.learns_preferences() && !matches!(self, Self::TrueOnlineSarsaLambda { .. })
    }

    /// The algorithm with the time limit of a run, which Monte Carlo methods need.
    #[must_use]
    pub(crate) fn with_time_limit(mut self, steps: u64) -> Self {
        if let Self::MonteCarlo { max_episode_steps }
        | Self::MonteCarloEs { max_episode_steps }
        | Self::OffPolicyMonteCarlo { max_episode_steps, .. } = &mut self
        {
            *max_episode_steps = steps;
        }
        self
    }

    /// Creates the learner of an agent and passes it to `visitor`. `second_table` is the other table of Double
    /// Q-learning, or the state values of a critic. The result is `None` if the algorithm needs single rows and `R`
    /// holds several, if it needs binary features and those of `R` are weighted, or if it needs a second table and there
    /// is none.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn learner<R, V>(
        self,
        agent: Agent,
        second_table: Option<QTable>,
        stop: &StopFlag<'_>,
        visitor: V,
    ) -> Result<Option<V::Output>, AllocationError>
    where
        R: ActiveRows + Send + 'static,
        V: LearnerVisitor<R>,
    {
        Ok(AnyLearner::new(self, agent, second_table, stop)?.and_then(|learner| learner.visit(visitor)))
    }
}
