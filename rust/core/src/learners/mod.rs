//! The learning algorithms, one per file. What they share is in `common`.

mod actor_critic;
mod actor_critic_lambda;
mod any_algorithm;
mod common;
mod differential_q_learning;
mod differential_sarsa;
mod double_q_learning;
mod dyna_q;
mod dyna_q_plus;
mod expected_sarsa;
mod gradient_bandit;
mod monte_carlo;
mod n_step_q_sigma;
mod n_step_sarsa;
mod n_step_tree_backup;
mod off_policy_monte_carlo;
mod prioritized_sweeping;
mod q_learning;
mod reinforce;
mod sarsa;
mod sarsa_lambda;
mod trace_options;
mod true_online_sarsa_lambda;
mod watkins_q_lambda;

pub use actor_critic::ActorCritic;
pub use actor_critic_lambda::ActorCriticLambda;
pub use any_algorithm::{AnyAlgorithm, LearnerVisitor};
pub(crate) use common::StepInParts;
pub use common::{
    ActionMasks, Agent, CountBonus, Critic, DynaModel, Learner, Model, ModelEntry, NStep, NStepMethod, NStepVisit,
    PolicyGradientLearner, PolicyGradientRule, StochasticModel, TargetPolicy, TdLearner, TraceKind, Traces,
    TruncationHandling, UpdateRule,
};
pub use differential_q_learning::DifferentialQLearning;
pub use differential_sarsa::DifferentialSarsa;
pub use double_q_learning::DoubleQLearning;
pub use dyna_q::DynaQ;
pub use dyna_q_plus::DynaQPlus;
pub use expected_sarsa::ExpectedSarsa;
pub use gradient_bandit::GradientBandit;
pub use monte_carlo::MonteCarloControl;
pub use n_step_q_sigma::{NStepQSigma, QSigma};
pub use n_step_sarsa::{NStepReturn, NStepSarsa};
pub use n_step_tree_backup::{NStepTreeBackup, TreeBackup};
pub use off_policy_monte_carlo::OffPolicyMonteCarlo;
pub use prioritized_sweeping::PrioritizedSweeping;
pub use q_learning::QLearning;
pub use reinforce::Reinforce;
pub use sarsa::Sarsa;
pub use sarsa_lambda::SarsaLambda;
pub use trace_options::TraceOptions;
pub use true_online_sarsa_lambda::TrueOnlineSarsaLambda;
pub use watkins_q_lambda::WatkinsQLambda;
