//! The truth: dynamic programming over a table (Sutton & Barto, 2nd ed., chapter 4), and a search where there is none.

mod bellman;
mod cost_to_go;
mod ending;
mod finite_horizon;
mod mountain_car;
mod policy_iteration;
mod process;
mod value_iteration;

use std::error::Error;
use std::fmt;

pub use bellman::MOST_SWEEPS;
pub use cost_to_go::CostToGo;
pub use finite_horizon::{Change, FiniteHorizon, finite_horizon, policy_return};
pub use mountain_car::{BEAM, STARTS, follow, route, starts};
pub use policy_iteration::policy_iteration;
pub use process::Process;
pub use value_iteration::value_iteration;

/// A policy that never changes, and what it is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// For each state the discounted return to come.
    pub values: Vec<f64>,
    /// The same for each state and action, the actions of state 0 first.
    pub q_values: Vec<f64>,
    /// For each state the best action.
    pub policy: Vec<usize>,
    /// How often all states were looked at.
    pub sweeps: u64,
}

/// Why there is no solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsolved {
    /// The caller asked to stop.
    Stopped,
    /// The values still change after [`MOST_SWEEPS`].
    Unsettled,
    /// From this state no episode ends, and its rewards add up without a discount.
    NeverEnds(usize),
    /// From this state rewards can be collected for ever.
    Endless(usize),
}

impl fmt::Display for Unsolved {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stopped => write!(formatter, "it was stopped"),
            Self::Unsettled => write!(formatter, "the values still change after {MOST_SWEEPS} sweeps"),
            Self::NeverEnds(state) => write!(formatter, "from state {state} no episode ends"),
            Self::Endless(state) => write!(formatter, "from state {state} rewards can be collected without an end"),
        }
    }
}

impl Error for Unsolved {}

#[cfg(test)]
mod tests;
