//! The result of planning without a time limit.

/// A stationary policy and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The value of each state: the expected discounted return.
    pub values: Vec<f64>,
    /// The value of each state-action pair, the actions of state 0 first.
    pub q_values: Vec<f64>,
    /// The best action of each state.
    pub policy: Vec<usize>,
    /// The number of sweeps over all states.
    pub sweeps: u64,
}
