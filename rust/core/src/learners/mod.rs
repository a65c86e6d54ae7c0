//! The learning algorithms, one per file. What they share is in `common`.

mod actor_critic;
mod actor_critic_lambda;
mod any_algorithm;
mod common;
mod double_q_learning;
mod dyna_q;
mod dyna_q_plus;
mod expected_sarsa;
mod gradient_bandit;
mod n_step_sarsa;
mod q_learning;
mod reinforce;
mod sarsa;
mod sarsa_lambda;
mod true_online_sarsa_lambda;
mod watkins_q_lambda;

pub use actor_critic::ActorCritic;
pub use actor_critic_lambda::ActorCriticLambda;
pub use any_algorithm::{AnyAlgorithm, LearnerVisitor, TraceOptions};
pub use common::{
    ActionMasks, Agent, Critic, Learner, Model, ModelEntry, PolicyGradientLearner, PolicyGradientRule, TdLearner,
    TraceKind, Traces, TruncationHandling, UpdateRule,
};
pub use double_q_learning::DoubleQLearning;
pub use dyna_q::DynaQ;
pub use dyna_q_plus::DynaQPlus;
pub use expected_sarsa::ExpectedSarsa;
pub use gradient_bandit::GradientBandit;
pub use n_step_sarsa::NStepSarsa;
pub use q_learning::QLearning;
pub use reinforce::Reinforce;
pub use sarsa::Sarsa;
pub use sarsa_lambda::SarsaLambda;
pub use true_online_sarsa_lambda::TrueOnlineSarsaLambda;
pub use watkins_q_lambda::WatkinsQLambda;
