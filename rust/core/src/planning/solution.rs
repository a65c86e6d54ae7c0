//! The result of planning without a time limit.

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
