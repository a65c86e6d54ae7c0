//! Planning: dynamic programming over a table (Sutton & Barto, 2nd ed., chapter 4), and over grids for classic control.

mod bellman;
mod best_policy;
mod elimination;
mod endings;
mod expected_updates;
mod finite_horizon;
pub mod grid;
mod markov_chain;
mod mdp;
mod planning_error;
mod policy_evaluation;
mod policy_iteration;
mod stationary;
mod stop_checks;
mod sweeps;
#[cfg(test)]
mod tests;
mod value_iteration;

pub use bellman::action_values;
pub use expected_updates::{ExpectedUpdates, UpdateDistribution};
pub use finite_horizon::{FiniteHorizon, PolicyChange, finite_horizon, policy_return};
pub use mdp::Mdp;
pub use planning_error::{MAX_SWEEPS, PlanningError};
pub use policy_evaluation::{PolicyEvaluation, expected_visits, policy_evaluation};
pub use policy_iteration::{Solution, policy_improvement, policy_iteration};
pub use stationary::{StationaryPolicy, stationary_policy};
pub use sweeps::sweep;
pub use value_iteration::value_iteration;
