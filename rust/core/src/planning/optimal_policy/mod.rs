//! Optimal policies without a time limit: policy iteration and value iteration (Sutton & Barto, sections 4.3 and 4.4).

mod best_policy;
mod endings;
mod policy_iteration;
mod value_iteration;

pub use policy_iteration::{Solution, policy_improvement, policy_iteration};
pub use value_iteration::value_iteration;
