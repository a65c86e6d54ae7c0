//! The learners, one a file; then what they share.

mod double_q_learning;
mod dyna_q;
mod dyna_q_plus;
mod expected_sarsa;
mod n_step_sarsa;
mod q_learning;
mod sarsa;
mod sarsa_lambda;
mod true_online_sarsa_lambda;
mod watkins_q_lambda;

mod agent;
mod control;
mod epsilon_greedy;
#[cfg(test)]
mod example;
mod model;
mod policy;
mod schedule;
mod step_size;
mod time_outs;
mod traces;

pub use agent::{Agent, TerminalUpdate};
pub use control::{Control, Rule};
pub use double_q_learning::DoubleQLearning;
pub use dyna_q::DynaQ;
pub use dyna_q_plus::DynaQPlus;
pub use epsilon_greedy::EpsilonGreedy;
pub use expected_sarsa::ExpectedSarsa;
pub use model::{Model, Outcome};
pub use n_step_sarsa::NStepSarsa;
pub use policy::{Behaviour, Policy, Softmax, Ties};
pub use q_learning::QLearning;
pub use sarsa::Sarsa;
pub use sarsa_lambda::SarsaLambda;
pub use schedule::{Decay, Schedule};
pub use step_size::{Rate, StepSize};
pub use time_outs::TimeOuts;
pub use traces::{Trace, Traces};
pub use true_online_sarsa_lambda::TrueOnlineSarsaLambda;
pub use watkins_q_lambda::WatkinsQLambda;
