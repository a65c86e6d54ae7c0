//! The learner of an algorithm chosen at run time.

use super::{
    ActorCritic, ActorCriticLambda, Agent, AnyAlgorithm, Critic, DifferentialQLearning, DifferentialSarsa,
    DoubleQLearning, DynaQ, DynaQPlus, ExpectedSarsa, FeatureKinds, GradientBandit, Learner, Model, MonteCarloControl,
    NStepQSigma, NStepSarsa, NStepTreeBackup, OffPolicyMonteCarlo, PrioritizedSweeping, QLearning, Reinforce, Sarsa,
    SarsaLambda, StochasticModel, TdLearner, TraceOptions, Traces, TrueOnlineSarsaLambda, WatkinsQLambda,
};
use crate::checkpoint::RunIdentity;
use crate::delegate_learner;
use crate::features::ActiveRows;
use crate::memory::AllocationError;
use crate::{QTable, StopFlag};

/// Receives the learner that [`AnyAlgorithm::learner`] creates, whatever its type.
pub trait LearnerVisitor<R> {
    /// The result.
    type Output;

    /// Receives the learner.
    fn visit<L: Learner<R> + Send + 'static>(self, learner: L) -> Self::Output;
}

/// Whether active rows `R` are always a single row. This is known at compile time, so learners that need single rows are
/// not compiled for several.
const fn is_single<R>() -> bool {
    size_of::<R>() == size_of::<u32>()
}

/// Defines the enum of all learners: those for any features, and those that need a single row.
macro_rules! any_learner {
    (
        any { $($any:ident $any_rule:ty,)+ }
        single { $($single:ident $single_rule:ty,)+ }
    ) => {
        /// The learner of any algorithm, for states with active rows `R`: what
        /// [`TrainerBuilder`](crate::TrainerBuilder) trains. A [`TdLearner`] of a known rule, policy and number of
        /// actions is faster.
        #[derive(Clone, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum AnyLearner<R: ActiveRows> {
            $(#[doc = concat!("The learner with the rule `", stringify!($any_rule), "`.")]
            $any(TdLearner<$any_rule>),)+
            $(#[doc = concat!("The learner with the rule `", stringify!($single_rule), "`.")]
            $single(TdLearner<$single_rule>),)+
        }

        impl<R: ActiveRows> Learner<R> for AnyLearner<R> {
            delegate_learner!(
                all R,
                learner in $(Self::$any(learner),)+ $(Self::$single(learner)),+
            );

            fn identify(&self, identity: &mut RunIdentity) {
                match self {
                    $(Self::$any(learner) => Learner::<R>::identify(learner, identity),)+
                    $(Self::$single(learner) => Learner::<R>::identify(learner, identity),)+
                }
            }
        }

        impl<R: ActiveRows> AnyLearner<R> {
            /// The agent of the learner: its table, its policy and the constants of its updates.
            pub fn agent(&self) -> &Agent {
                match self {
                    $(Self::$any(learner) => &learner.agent,)+
                    $(Self::$single(learner) => &learner.agent,)+
                }
            }
        }

        impl<R: ActiveRows + Send + 'static> AnyLearner<R> {
            /// Passes the learner to `visitor`; `None` if it needs a single active row and `R` may hold several.
            pub(super) fn visit<V: LearnerVisitor<R>>(self, visitor: V) -> Option<V::Output> {
                match self {
                    $(Self::$any(learner) => Some(visitor.visit(learner)),)+
                    $(Self::$single(learner) if is_single::<R>() => Some(visitor.visit(learner)),)+
                    $(Self::$single(_) => None,)+
                }
            }
        }
    };
}

any_learner! {
    any {
    QLearning QLearning,
    Sarsa Sarsa,
    ExpectedSarsa ExpectedSarsa,
    DoubleQLearning DoubleQLearning,
    NStepSarsa NStepSarsa<R>,
    NStepTreeBackup NStepTreeBackup<R>,
    NStepQSigma NStepQSigma<R>,
    DifferentialSarsa DifferentialSarsa<R>,
    DifferentialQLearning DifferentialQLearning<R>,
    SarsaLambda SarsaLambda,
    TrueOnlineSarsaLambda TrueOnlineSarsaLambda,
    WatkinsQLambda WatkinsQLambda,
    Reinforce Reinforce<R>,
    ActorCritic ActorCritic,
    ActorCriticLambda ActorCriticLambda,
    }
    single {
    DynaQ DynaQ,
    DynaQPlus DynaQPlus,
    StochasticDynaQ DynaQ<StochasticModel>,
    PrioritizedSweeping PrioritizedSweeping,
    MonteCarloControl MonteCarloControl,
    OffPolicyMonteCarlo OffPolicyMonteCarlo,
    GradientBandit GradientBandit,
    }
}

impl<R: ActiveRows> AnyLearner<R> {
    /// The learner of an algorithm. `second_table` is the other table of Double Q-learning, or the state values of a
    /// critic. The result is `None` if the algorithm needs single rows and `R` may hold several, if it needs binary
    /// features and those of `R` are weighted, or if it needs a second table and there is none.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    ///
    /// # Panics
    /// If `n_steps` is 0.
    pub fn new(
        algorithm: AnyAlgorithm,
        agent: Agent,
        second_table: Option<QTable>,
        stop: &StopFlag<'_>,
    ) -> Result<Option<Self>, AllocationError> {
        let fits = match algorithm.feature_kinds() {
            FeatureKinds::All => true,
            FeatureKinds::Binary => !R::WEIGHTED,
            FeatureKinds::SingleRows => is_single::<R>(),
        };
        if !fits || algorithm.n_tables() == 2 && second_table.is_none() {
            return Ok(None);
        }
        let (n_rows, num_actions) = agent.table.shape();
        let weights = n_rows * num_actions;
        let new_model = || Model::new(n_rows, num_actions, stop);
        // Dense traces take no places.
        let places = if R::WEIGHTED { 0 } else { weights };
        let new_traces = |cutoff: f64| Traces::new(places, cutoff, stop);
        let new_critic = |table, learning_rate: f64| Critic::new(table, learning_rate, &agent.learning_rate);
        macro_rules! learner {
            ($variant:ident, $rule:expr) => {
                Self::$variant(TdLearner { rule: $rule, agent })
            };
        }
        Ok(Some(match algorithm {
            AnyAlgorithm::QLearning => learner!(QLearning, QLearning),
            AnyAlgorithm::Sarsa => learner!(Sarsa, Sarsa),
            AnyAlgorithm::ExpectedSarsa => learner!(ExpectedSarsa, ExpectedSarsa),
            AnyAlgorithm::DoubleQLearning => {
                let Some(second_table) = second_table else { return Ok(None) };
                learner!(DoubleQLearning, DoubleQLearning::new(agent.learning_rate.clone(), second_table))
            }
            AnyAlgorithm::NStepSarsa { n_steps } => learner!(NStepSarsa, NStepSarsa::new(n_steps)),
            AnyAlgorithm::SarsaLambda(TraceOptions { kind, decay, cutoff }) => {
                learner!(SarsaLambda, SarsaLambda { traces: new_traces(cutoff)?, kind, trace_decay: decay })
            }
            AnyAlgorithm::TrueOnlineSarsaLambda { trace_decay, trace_cutoff } => {
                learner!(TrueOnlineSarsaLambda, TrueOnlineSarsaLambda::new(new_traces(trace_cutoff)?, trace_decay))
            }
            AnyAlgorithm::WatkinsQLambda(TraceOptions { kind, decay, cutoff }) => {
                learner!(WatkinsQLambda, WatkinsQLambda { traces: new_traces(cutoff)?, kind, trace_decay: decay })
            }
            AnyAlgorithm::DynaQ { planning_steps } => learner!(DynaQ, DynaQ::new(new_model()?, planning_steps)),
            AnyAlgorithm::DynaQPlus { planning_steps, time_weight } => {
                learner!(DynaQPlus, DynaQPlus::new(new_model()?, planning_steps, time_weight, stop)?)
            }
            AnyAlgorithm::StochasticDynaQ { planning_steps } => {
                let model = StochasticModel::new(n_rows, num_actions, stop)?;
                learner!(StochasticDynaQ, DynaQ::new(model, planning_steps))
            }
            AnyAlgorithm::MonteCarlo { max_episode_steps } | AnyAlgorithm::MonteCarloEs { max_episode_steps } => {
                let exploring_starts = matches!(algorithm, AnyAlgorithm::MonteCarloEs { .. });
                let rule = MonteCarloControl::new(weights, max_episode_steps, exploring_starts, stop)?;
                learner!(MonteCarloControl, rule)
            }
            AnyAlgorithm::OffPolicyMonteCarlo { max_episode_steps, learning_rate, min_learning_rate } => {
                let rates = (learning_rate, min_learning_rate);
                learner!(OffPolicyMonteCarlo, OffPolicyMonteCarlo::new(weights, max_episode_steps, rates, stop)?)
            }
            AnyAlgorithm::NStepTreeBackup { n_steps, target_policy } => {
                learner!(NStepTreeBackup, NStepTreeBackup::new(n_steps, target_policy))
            }
            AnyAlgorithm::NStepQSigma { n_steps, sigma, target_policy } => {
                learner!(NStepQSigma, NStepQSigma::new(n_steps, sigma, target_policy))
            }
            AnyAlgorithm::PrioritizedSweeping { planning_steps, priority_threshold } => {
                let rule = PrioritizedSweeping::new(new_model()?, planning_steps, priority_threshold, stop)?;
                learner!(PrioritizedSweeping, rule)
            }
            AnyAlgorithm::DifferentialSarsa { reward_learning_rate } => {
                learner!(DifferentialSarsa, DifferentialSarsa::new(reward_learning_rate))
            }
            AnyAlgorithm::DifferentialQLearning { reward_learning_rate } => {
                learner!(DifferentialQLearning, DifferentialQLearning::new(reward_learning_rate))
            }
            AnyAlgorithm::GradientBandit { baseline } => {
                learner!(GradientBandit, GradientBandit::new(baseline, n_rows, stop)?)
            }
            AnyAlgorithm::Reinforce => learner!(Reinforce, Reinforce::new(None)),
            AnyAlgorithm::ReinforceWithBaseline { value_learning_rate } => {
                let critic = second_table.map(|table| new_critic(table, value_learning_rate));
                learner!(Reinforce, Reinforce::new(critic))
            }
            AnyAlgorithm::ActorCritic { value_learning_rate } => {
                let Some(table) = second_table else { return Ok(None) };
                learner!(ActorCritic, ActorCritic::new(new_critic(table, value_learning_rate)))
            }
            AnyAlgorithm::ActorCriticLambda { value_learning_rate, trace_decay } => {
                let Some(table) = second_table else { return Ok(None) };
                let rule = ActorCriticLambda::new(new_critic(table, value_learning_rate), trace_decay, stop)?;
                learner!(ActorCriticLambda, rule)
            }
        }))
    }
}
