//! An algorithm chosen at run time, and the construction of its learner.

use super::{
    ActorCritic, ActorCriticLambda, Agent, Critic, DifferentialQLearning, DifferentialSarsa, DoubleQLearning, DynaQ,
    DynaQPlus, ExpectedSarsa, GradientBandit, Learner, Model, MonteCarloControl, NStepQSigma, NStepSarsa,
    NStepTreeBackup, OffPolicyMonteCarlo, PrioritizedSweeping, QLearning, Reinforce, Sarsa, SarsaLambda,
    StochasticModel, TargetPolicy, TdLearner, TraceOptions, Traces, TrueOnlineSarsaLambda, UpdateRule, WatkinsQLambda,
};
use crate::features::ActiveRows;
use crate::memory::AllocationError;
use crate::{QTable, StopFlag};

/// One of the algorithms with its options.
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// Receives the learner that [`AnyAlgorithm::learner`] creates, whatever its type.
pub trait LearnerVisitor<R> {
    /// The result.
    type Output;

    /// Receives the learner.
    fn visit<L: Learner<R> + Send + 'static>(self, learner: L) -> Self::Output;
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

    /// Whether each state must have exactly one active row: for a model, for a baseline of each state, or for visit
    /// counts.
    pub fn needs_single_rows(&self) -> bool {
        matches!(
            self,
            Self::DynaQ { .. }
                | Self::DynaQPlus { .. }
                | Self::StochasticDynaQ { .. }
                | Self::MonteCarlo { .. }
                | Self::MonteCarloEs { .. }
                | Self::OffPolicyMonteCarlo { .. }
                | Self::PrioritizedSweeping { .. }
                | Self::GradientBandit { .. }
        )
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

    /// Creates the learner of an agent and passes it to `visitor`. `second_table` is the other table of Double
    /// Q-learning, or the state values of a critic. The result is `None` if the algorithm needs single rows and `R`
    /// holds several, or if it needs a second table and there is none.
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
        // This is known at compile time, so algorithms that need single rows are not compiled for several rows.
        if self.needs_single_rows() && size_of::<R>() != size_of::<u32>() {
            return Ok(None);
        }
        let (n_rows, num_actions) = agent.table.shape();
        let n_active = agent.learning_rate.n_active();
        let new_critic = |table, learning_rate: f64| Critic { table, step_size: learning_rate / n_active };
        let new_model = || Model::new(n_rows, num_actions, stop);
        let new_traces = |cutoff: f64| Traces::new(n_rows * num_actions, cutoff, stop);
        Ok(Some(match self {
            Self::QLearning => with_rule(agent, QLearning, visitor),
            Self::Sarsa => with_rule(agent, Sarsa, visitor),
            Self::ExpectedSarsa => with_rule(agent, ExpectedSarsa, visitor),
            Self::DoubleQLearning => match second_table {
                Some(second_table) => {
                    let rule = DoubleQLearning::new(agent.learning_rate.clone(), second_table);
                    with_rule(agent, rule, visitor)
                }
                None => return Ok(None),
            },
            Self::NStepSarsa { n_steps } => with_rule(agent, NStepSarsa::new(n_steps), visitor),
            Self::SarsaLambda(TraceOptions { kind, decay, cutoff }) => {
                with_rule(agent, SarsaLambda { traces: new_traces(cutoff)?, kind, trace_decay: decay }, visitor)
            }
            Self::TrueOnlineSarsaLambda { trace_decay, trace_cutoff } => {
                with_rule(agent, TrueOnlineSarsaLambda::new(new_traces(trace_cutoff)?, trace_decay), visitor)
            }
            Self::WatkinsQLambda(TraceOptions { kind, decay, cutoff }) => {
                with_rule(agent, WatkinsQLambda { traces: new_traces(cutoff)?, kind, trace_decay: decay }, visitor)
            }
            Self::DynaQ { planning_steps } => with_rule(agent, DynaQ::new(new_model()?, planning_steps), visitor),
            Self::DynaQPlus { planning_steps, time_weight } => {
                with_rule(agent, DynaQPlus::new(new_model()?, planning_steps, time_weight, stop)?, visitor)
            }
            Self::StochasticDynaQ { planning_steps } => {
                let model = StochasticModel::new(n_rows, num_actions, stop)?;
                with_rule(agent, DynaQ::new(model, planning_steps), visitor)
            }
            Self::MonteCarlo { max_episode_steps } | Self::MonteCarloEs { max_episode_steps } => {
                let exploring_starts = matches!(self, Self::MonteCarloEs { .. });
                let rule = MonteCarloControl::new(n_rows * num_actions, max_episode_steps, exploring_starts, stop)?;
                with_rule(agent, rule, visitor)
            }
            Self::OffPolicyMonteCarlo { max_episode_steps, learning_rate, min_learning_rate } => {
                let rates = (learning_rate, min_learning_rate);
                let rule = OffPolicyMonteCarlo::new(n_rows * num_actions, max_episode_steps, rates, stop)?;
                with_rule(agent, rule, visitor)
            }
            Self::NStepTreeBackup { n_steps, target_policy } => {
                with_rule(agent, NStepTreeBackup::new(n_steps, target_policy), visitor)
            }
            Self::NStepQSigma { n_steps, sigma, target_policy } => {
                with_rule(agent, NStepQSigma::new(n_steps, sigma, target_policy), visitor)
            }
            Self::PrioritizedSweeping { planning_steps, priority_threshold } => {
                let rule = PrioritizedSweeping::new(new_model()?, planning_steps, priority_threshold, stop)?;
                with_rule(agent, rule, visitor)
            }
            Self::DifferentialSarsa { reward_learning_rate } => {
                with_rule(agent, DifferentialSarsa::new(reward_learning_rate), visitor)
            }
            Self::DifferentialQLearning { reward_learning_rate } => {
                with_rule(agent, DifferentialQLearning::new(reward_learning_rate), visitor)
            }
            Self::GradientBandit { baseline } => {
                with_rule(agent, GradientBandit::new(baseline, n_rows, stop)?, visitor)
            }
            Self::Reinforce => with_rule(agent, Reinforce::new(None), visitor),
            Self::ReinforceWithBaseline { value_learning_rate } => match second_table {
                Some(table) => with_rule(agent, Reinforce::new(Some(new_critic(table, value_learning_rate))), visitor),
                None => return Ok(None),
            },
            Self::ActorCritic { value_learning_rate } => match second_table {
                Some(table) => with_rule(agent, ActorCritic::new(new_critic(table, value_learning_rate)), visitor),
                None => return Ok(None),
            },
            Self::ActorCriticLambda { value_learning_rate, trace_decay } => match second_table {
                Some(table) => {
                    let critic = new_critic(table, value_learning_rate);
                    with_rule(agent, ActorCriticLambda::new(critic, trace_decay, stop)?, visitor)
                }
                None => return Ok(None),
            },
        }))
    }
}

fn with_rule<R, U, V>(agent: Agent, rule: U, visitor: V) -> V::Output
where
    R: ActiveRows + Send + 'static,
    U: UpdateRule<R, Agent> + Send + 'static,
    V: LearnerVisitor<R>,
{
    visitor.visit(TdLearner { agent, rule })
}
