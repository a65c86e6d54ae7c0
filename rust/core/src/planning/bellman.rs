//! The Bellman equations for a transition table, which all methods here share.

use crate::StopFlag;

use super::stop_checks::StopChecks;
use super::{MAX_SWEEPS, PlanningError};
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::with_capacity;

/// Values may have converged when a sweep changes none by more than this fraction of the largest: their last bits.
const CONVERGED: f64 = 4.0 * f64::EPSILON;
/// Two actions tie when their values differ by less than this fraction of the largest value. It exceeds the error of
/// converged values.
const TIE_TOLERANCE: f64 = 1e-10;

/// q(s, a) = Σ p (r + γ v(s′)), summed from left to right (Sutton & Barto, equation 4.6). Terminal states have the value
/// 0.
#[inline]
pub(super) fn action_value(mdp: &TabularMdp, state: usize, action: usize, discount: f64, values: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (probability, step) in mdp.outcomes(state, action) {
        let next_value = if step.terminated { 0.0 } else { values[step.state as usize] };
        sum += probability * (step.reward + discount * next_value);
    }
    sum
}

/// maxₐ q(s, a).
#[inline]
pub(super) fn best_value(mdp: &TabularMdp, state: usize, discount: f64, values: &[f64]) -> f64 {
    (0..mdp.num_actions())
        .map(|action| action_value(mdp, state, action, discount, values))
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Σ π(a|s) q(s, a), summed from left to right (Sutton & Barto, equation 4.4). `policy` holds π(a|s), the actions of
/// state 0 first. Actions that it never takes are left out.
#[inline]
pub(super) fn expected_value(mdp: &TabularMdp, policy: &[f64], state: usize, discount: f64, values: &[f64]) -> f64 {
    choices(mdp, policy, state)
        .fold(0.0, |sum, (action, probability)| sum + probability * action_value(mdp, state, action, discount, values))
}

/// The actions that a policy takes in a state, and their probabilities.
pub(super) fn choices<'a>(
    mdp: &TabularMdp,
    policy: &'a [f64],
    state: usize,
) -> impl Iterator<Item = (usize, f64)> + use<'a> {
    let row = &policy[state * mdp.num_actions()..][..mdp.num_actions()];
    row.iter().copied().enumerate().filter(|&(_, probability)| probability > 0.0)
}

/// q(s, a) of all states and actions, the actions of state 0 first.
pub(super) fn action_values(
    mdp: &TabularMdp,
    discount: f64,
    values: &[f64],
    stop: &StopFlag<'_>,
) -> Result<Vec<f64>, PlanningError> {
    let mut checks = StopChecks::new(mdp, stop);
    let mut q_values = with_capacity(mdp.num_states() * mdp.num_actions())?;
    for state in 0..mdp.num_states() {
        q_values.extend((0..mdp.num_actions()).map(|action| action_value(mdp, state, action, discount, values)));
        checks.state()?;
    }
    Ok(q_values)
}

/// The difference up to which the values of two actions count as equal.
pub(super) fn tie_tolerance(values: &[f64]) -> f64 {
    TIE_TOLERANCE * values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()))
}

/// Sweeps over the states and replaces each value in place by `backup(state, values)`, until the changes are in the last
/// bits and no longer shrink. Returns the number of sweeps.
pub(super) fn converge(
    values: &mut [f64],
    mdp: &TabularMdp,
    stop: &StopFlag<'_>,
    mut backup: impl FnMut(usize, &[f64]) -> f64,
) -> Result<u64, PlanningError> {
    let mut checks = StopChecks::new(mdp, stop);
    let mut previous_change = f64::INFINITY;
    for sweeps in 1..=MAX_SWEEPS {
        let (mut change, mut largest) = (0.0_f64, 0.0_f64);
        for state in 0..values.len() {
            let value = backup(state, values);
            change = change.max((value - values[state]).abs());
            largest = largest.max(value.abs());
            values[state] = value;
            checks.state()?;
        }
        if change == 0.0 || (change <= CONVERGED * largest && change >= previous_change) {
            return Ok(sweeps);
        }
        previous_change = change;
        checks.now()?;
    }
    Err(PlanningError::NotConverged)
}
