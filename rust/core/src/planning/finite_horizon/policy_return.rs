//! The return of a policy under a time limit.

use std::mem::swap;

use crate::StopFlag;
use crate::envs::tabular::TabularMdp;
use crate::planning::PlanningError;
use crate::planning::problem::{Problem, initial_value};

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
    let (problem, num_states) = (Problem { mdp, discount: 1.0, stop }, mdp.num_states());
    let is_stationary = policy.len() == num_states;
    let fits = is_stationary || policy.len() as u64 == num_states as u64 * steps;
    assert!(fits, "a policy must have one action per state, or one per step and state");
    let (mut returns, mut next_returns) = (problem.zeros()?, problem.zeros()?);
    let mut checks = problem.checks();
    for taken in (0..steps).rev() {
        checks.now()?;
        let first = if is_stationary { 0 } else { taken as usize * num_states };
        for (state, &action) in policy[first..][..num_states].iter().enumerate() {
            next_returns[state] = problem.action_value(state, action, &returns);
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
    let problem = Problem { mdp, discount: 1.0, stop };
    let zeros = || problem.zeros();
    let (mut returns, mut next_returns, mut errors, mut next_errors) = (zeros()?, zeros()?, zeros()?, zeros()?);
    let mut checks = problem.checks();
    for _ in 0..steps {
        checks.now()?;
        for (state, &action) in policy.iter().enumerate() {
            next_returns[state] = problem.action_value(state, action, &returns);
            next_errors[state] = problem.action_error(state, action, &returns, &errors);
            checks.state()?;
        }
        swap(&mut returns, &mut next_returns);
        swap(&mut errors, &mut next_errors);
    }
    Ok(initial_value(mdp, &errors))
}
