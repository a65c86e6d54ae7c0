//! Backward induction over the time limit, which is exact: the best action with one step to go, with two steps, …
//!
//! Vₖ(s) = maxₐ Σ p (r + γ Vₖ₋₁(s′)) with V₀ = 0 (M. Puterman, *Markov Decision Processes*, 1994, section 4.5).

use crate::StopFlag;
use std::mem::swap;

use super::PlanningError;
use super::bellman::{action_error, action_value, action_values, initial_value};
use super::stop_checks::StopChecks;
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::{filled, reserve};
use crate::numeric::argmax;

/// The optimal policy under a time limit. It depends on the number of steps to go.
#[derive(Clone, Debug, PartialEq)]
pub struct FiniteHorizon {
    /// The value of each state with all steps to go: the expected discounted return.
    pub values: Vec<f64>,
    /// The value of each state-action pair with all steps to go.
    pub q_values: Vec<f64>,
    /// The best action of each state with all steps to go.
    pub policy: Vec<usize>,
    /// The policy with fewer steps to go, as changes in ascending order of the steps to go.
    pub changes: Vec<PolicyChange>,
    /// The expected undiscounted return of the policy from the initial states.
    pub expected_return: f64,
    /// The number of sweeps over all states: the time limit, or fewer if further steps change nothing.
    pub sweeps: u64,
}

/// A change of the policy: from this number of steps to go on, another action is best in a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PolicyChange {
    /// The number of steps to go from which on the action is best.
    pub steps_to_go: u64,
    /// The state.
    pub state: usize,
    /// The best action, up to the next change.
    pub action: usize,
}

/// The optimal policy over `steps` steps. Among tied actions it keeps the one that is best with fewer steps to go, so
/// that nothing is postponed, and otherwise takes the first. Actions tie if their difference may be due to rounding
/// alone.
///
/// # Errors
/// `Overflow`; `OutOfMemory`; `Stopped` after `stop` was set.
pub fn finite_horizon(
    mdp: &TabularMdp,
    discount: f64,
    steps: u64,
    stop: &StopFlag<'_>,
) -> Result<FiniteHorizon, PlanningError> {
    let zeros = || filled(&0.0, mdp.num_states(), stop);
    let (mut values, mut returns, mut next_values, mut next_returns) = (zeros()?, zeros()?, zeros()?, zeros()?);
    // Bounds on the errors of the values.
    let (mut errors, mut next_errors) = (zeros()?, zeros()?);
    let mut row = filled(&0.0, mdp.num_actions(), stop)?;
    let mut policy = filled(&usize::MAX, mdp.num_states(), stop)?;
    let mut checks = StopChecks::new(mdp, stop);
    let mut changes = Vec::new();
    let mut sweeps = 0;
    let mut converged = false;
    while sweeps < steps && !converged {
        checks.now()?;
        sweeps += 1;
        for (state, kept) in policy.iter_mut().enumerate() {
            for (action, value) in row.iter_mut().enumerate() {
                *value = action_value(mdp, state, action, discount, &values);
            }
            let best = argmax(&row);
            let error_of = |action| action_error(mdp, state, action, discount, &values, &errors);
            next_errors[state] = error_of(best);
            let is_better =
                |kept: usize| row[best] > row[kept] && row[best] - row[kept] > error_of(kept) + error_of(best);
            if *kept == usize::MAX || is_better(*kept) {
                *kept = best;
                reserve(&mut changes, 1)?;
                changes.push(PolicyChange { steps_to_go: sweeps, state, action: best });
            }
            next_values[state] = row[best];
            next_returns[state] = action_value(mdp, state, *kept, 1.0, &returns);
            if !(next_values[state].is_finite() && next_returns[state].is_finite()) {
                return Err(PlanningError::Overflow(state));
            }
            checks.state()?;
        }
        swap(&mut values, &mut next_values);
        swap(&mut errors, &mut next_errors);
        swap(&mut returns, &mut next_returns);
        // Once the values repeat, they repeat for any further number of steps.
        converged = values == next_values && returns == next_returns;
    }
    // With all steps to go, the next state has one step fewer.
    let q_values = action_values(mdp, discount, &next_values, stop)?;
    let expected_return = initial_value(mdp, &returns);
    Ok(FiniteHorizon { values, q_values, policy, changes, expected_return, sweeps })
}

/// The expected undiscounted return of a policy within `steps` steps. The policy has one action per state, or one per
/// step and state, those of the first step first.
///
/// # Errors
/// `Overflow`; `OutOfMemory`; `Stopped` after `stop` was set.
///
/// # Panics
/// If the policy has another number of actions, or an action is out of range.
pub fn policy_return(
    mdp: &TabularMdp,
    policy: &[usize],
    steps: u64,
    stop: &StopFlag<'_>,
) -> Result<f64, PlanningError> {
    let num_states = mdp.num_states();
    let is_stationary = policy.len() == num_states;
    let fits = is_stationary || policy.len() as u64 == num_states as u64 * steps;
    assert!(fits, "a policy must have one action per state, or one per step and state");
    let (mut returns, mut next_returns) = (filled(&0.0, num_states, stop)?, filled(&0.0, num_states, stop)?);
    let mut checks = StopChecks::new(mdp, stop);
    for taken in (0..steps).rev() {
        checks.now()?;
        let first = if is_stationary { 0 } else { taken as usize * num_states };
        for (state, &action) in policy[first..][..num_states].iter().enumerate() {
            next_returns[state] = action_value(mdp, state, action, 1.0, &returns);
            if !next_returns[state].is_finite() {
                return Err(PlanningError::Overflow(state));
            }
            checks.state()?;
        }
        swap(&mut returns, &mut next_returns);
        if is_stationary && returns == next_returns {
            break;
        }
    }
    Ok(initial_value(mdp, &returns))
}

/// A bound of the rounding error of [`policy_return`], for a policy with one action per state.
///
/// # Errors
/// `OutOfMemory`; `Stopped` after `stop` was set.
pub(super) fn return_error(
    mdp: &TabularMdp,
    policy: &[usize],
    steps: u64,
    stop: &StopFlag<'_>,
) -> Result<f64, PlanningError> {
    let zeros = || filled(&0.0, mdp.num_states(), stop);
    let (mut returns, mut next_returns, mut errors, mut next_errors) = (zeros()?, zeros()?, zeros()?, zeros()?);
    let mut checks = StopChecks::new(mdp, stop);
    for _ in 0..steps {
        checks.now()?;
        for (state, &action) in policy.iter().enumerate() {
            next_returns[state] = action_value(mdp, state, action, 1.0, &returns);
            next_errors[state] = action_error(mdp, state, action, 1.0, &returns, &errors);
            checks.state()?;
        }
        swap(&mut returns, &mut next_returns);
        swap(&mut errors, &mut next_errors);
    }
    Ok(initial_value(mdp, &errors))
}
