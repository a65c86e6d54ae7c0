//! Backward induction over the time limit, which is exact: the best action with one step to go, with two steps, …
//!
//! Vₖ(s) = maxₐ Σ p (r + γ Vₖ₋₁(s′)) with V₀ = 0 (M. Puterman, *Markov Decision Processes*, 1994, section 4.5).

use std::mem::swap;

use crate::StopFlag;
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::{filled, reserve};
use crate::numeric::argmax;
use crate::planning::PlanningError;
use crate::planning::problem::{Problem, initial_value};

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
    let problem = Problem { mdp, discount, stop };
    let undiscounted = Problem { discount: 1.0, ..problem };
    let zeros = || problem.zeros();
    let (mut values, mut returns, mut next_values, mut next_returns) = (zeros()?, zeros()?, zeros()?, zeros()?);
    // Bounds on the errors of the values.
    let (mut errors, mut next_errors) = (zeros()?, zeros()?);
    let mut row = filled(&0.0, mdp.num_actions(), stop)?;
    let mut policy = filled(&usize::MAX, mdp.num_states(), stop)?;
    let mut checks = problem.checks();
    let mut changes = Vec::new();
    let mut sweeps = 0;
    let mut converged = false;
    while sweeps < steps && !converged {
        checks.now()?;
        sweeps += 1;
        for (state, kept) in policy.iter_mut().enumerate() {
            for (action, value) in row.iter_mut().enumerate() {
                *value = problem.action_value(state, action, &values);
            }
            let best = argmax(&row);
            let error_of = |action| problem.action_error(state, action, &values, &errors);
            next_errors[state] = error_of(best);
            let is_better =
                |kept: usize| row[best] > row[kept] && row[best] - row[kept] > error_of(kept) + error_of(best);
            if *kept == usize::MAX || is_better(*kept) {
                *kept = best;
                reserve(&mut changes, 1)?;
                changes.push(PolicyChange { steps_to_go: sweeps, state, action: best });
            }
            next_values[state] = row[best];
            next_returns[state] = undiscounted.action_value(state, *kept, &returns);
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
    let q_values = problem.action_values(&next_values)?;
    let expected_return = initial_value(mdp, &returns);
    Ok(FiniteHorizon { values, q_values, policy, changes, expected_return, sweeps })
}
