//! Methods that learn from each step alone, and bandits.

mod average_reward;
mod differential_q_learning;
mod differential_sarsa;
mod double_q_learning;
mod expected_sarsa;
mod gradient_bandit;
mod q_learning;
mod sarsa;

use average_reward::AverageReward;
pub use differential_q_learning::DifferentialQLearning;
pub use differential_sarsa::DifferentialSarsa;
pub use double_q_learning::DoubleQLearning;
pub use expected_sarsa::ExpectedSarsa;
pub use gradient_bandit::GradientBandit;
pub use q_learning::QLearning;
pub use sarsa::Sarsa;
