//! Planning: dynamic programming over a table (Sutton & Barto, 2nd ed., chapter 4), and over grids for classic control.

mod expected_updates;
mod finite_horizon;
pub mod grid;
mod markov_chain;
mod mdp;
mod optimal_policy;
mod planning_error;
mod policy_evaluation;
mod problem;
mod stop_checks;
mod sweeps;
#[cfg(test)]
mod tests;

pub use expected_updates::{ExpectedUpdates, UpdateDistribution};
pub use finite_horizon::{
    FiniteHorizon, PolicyChange, StationaryPolicy, finite_horizon, policy_return, stationary_policy,
};
pub use mdp::Mdp;
pub use optimal_policy::{Solution, policy_improvement, policy_iteration, value_iteration};
pub use planning_error::{MAX_SWEEPS, PlanningError};
pub use policy_evaluation::{PolicyEvaluation, expected_visits, policy_evaluation};
pub use problem::action_values;
pub use sweeps::sweep;
