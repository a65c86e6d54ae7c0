//! The learners, one a file.

mod epsilon_greedy;
mod q_learning;

pub use epsilon_greedy::EpsilonGreedy;
pub use q_learning::{QLearning, TerminalUpdate};
