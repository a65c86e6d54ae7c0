//! The Bellman equations for a transition table, shared by all planning methods.

use crate::StopFlag;

use super::PlanningError;
use super::stop_checks::StopChecks;
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::with_capacity;

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

/// Σ p (|r| + γ |v(s′)|): the sum of the magnitudes of an action value's terms.
pub(super) fn action_size(mdp: &TabularMdp, state: usize, action: usize, discount: f64, values: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (probability, step) in mdp.outcomes(state, action) {
        let next_value = if step.terminated { 0.0 } else { values[step.state as usize] };
        sum += probability * (step.reward.abs() + discount * next_value.abs());
    }
    sum
}

/// The magnitude of the terms of a state's largest action value, of the first one if several are equal. Those of other
/// actions, such as large penalties, do not matter.
pub(super) fn best_size(mdp: &TabularMdp, state: usize, discount: f64, values: &[f64]) -> f64 {
    let value = |action: usize| action_value(mdp, state, action, discount, values);
    let best = (1..mdp.num_actions()).fold((0, value(0)), |best, action| {
        let value = value(action);
        if value > best.1 { (action, value) } else { best }
    });
    action_size(mdp, state, best.0, discount, values)
}

/// A bound on the error of an action value, given the errors of the state values. Actions tie if their values differ by
/// less than the errors of both.
pub(super) fn action_error(
    mdp: &TabularMdp,
    state: usize,
    action: usize,
    discount: f64,
    values: &[f64],
    errors: &[f64],
) -> f64 {
    let size = action_size(mdp, state, action, discount, values).clamp(f64::MIN_POSITIVE, f64::MAX);
    let (outcomes, error) = mdp.outcomes(state, action).fold((0.0, 0.0), |(outcomes, error), (probability, step)| {
        let next_error = if step.terminated { 0.0 } else { errors[step.state as usize] };
        (outcomes + 1.0, error + probability * discount * next_error)
    });
    error + f64::EPSILON * (2.0 + outcomes) * size
}

/// maxₐ q(s, a).
#[inline]
pub(super) fn best_value(mdp: &TabularMdp, state: usize, discount: f64, values: &[f64]) -> f64 {
    (0..mdp.num_actions())
        .map(|action| action_value(mdp, state, action, discount, values))
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Σ π(a|s) q(s, a), summed from left to right (Sutton & Barto, equation 4.4). `policy` holds π(a|s), the actions of
/// state 0 first. Actions with probability 0 are left out.
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
///
/// # Errors
/// `Overflow`; `OutOfMemory`; `Stopped` after `stop` was set.
pub fn action_values(
    mdp: &TabularMdp,
    discount: f64,
    values: &[f64],
    stop: &StopFlag<'_>,
) -> Result<Vec<f64>, PlanningError> {
    let mut checks = StopChecks::new(mdp, stop);
    let mut q_values = with_capacity(mdp.num_states() * mdp.num_actions())?;
    for state in 0..mdp.num_states() {
        q_values.extend((0..mdp.num_actions()).map(|action| action_value(mdp, state, action, discount, values)));
        if q_values[state * mdp.num_actions()..].iter().any(|value| !value.is_finite()) {
            return Err(PlanningError::Overflow(state));
        }
        checks.state()?;
    }
    Ok(q_values)
}

/// The expected value of the initial state, summed from left to right.
pub(super) fn initial_value(mdp: &TabularMdp, values: &[f64]) -> f64 {
    mdp.initial_distribution().iter().zip(values).fold(0.0, |sum, (probability, value)| sum + probability * value)
}
