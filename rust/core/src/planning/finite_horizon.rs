//! Backward induction over the time limit: what is best with one step left, with two, …, exactly.
//!
//! `V_k(s) = max_a Σ p (r + γ V_{k-1}(s'))`, `V_0 = 0` (M. Puterman, *Markov Decision Processes*, 1994, section 4.5).

use std::mem::swap;
use std::sync::atomic::{AtomicBool, Ordering};

use super::PlanningError;
use super::bellman::{action_value, action_values};
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::numeric::argmax;

/// The best policy under a time limit, which depends on the steps that are left.
#[derive(Clone, Debug, PartialEq)]
pub struct FiniteHorizon {
    /// For each state the discounted return to come, with all steps left.
    pub values: Vec<f64>,
    /// The same for each state and action.
    pub q_values: Vec<f64>,
    /// For each state the best action, with all steps left.
    pub policy: Vec<usize>,
    /// The policy with fewer steps left, by what changes as they grow more.
    pub changes: Vec<PolicyChange>,
    /// The policy's return from the first states, without a discount.
    pub expected_return: f64,
    /// How often all states were looked at: the limit, or fewer where more steps change nothing.
    pub sweeps: u64,
}

/// From so many steps left on, another action is best.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PolicyChange {
    /// How many steps are left.
    pub steps_to_go: u64,
    /// Where.
    pub state: usize,
    /// The best action from there on.
    pub action: usize,
}

/// The best policy over `steps` steps. Of equally good actions it keeps the one that is best with fewer steps left, so
/// that nothing is put off; else it takes the first.
///
/// # Errors
/// `Stopped` after `stop` was set.
pub fn finite_horizon(
    table: &TabularMdp,
    discount: f64,
    steps: u64,
    stop: &AtomicBool,
) -> Result<FiniteHorizon, PlanningError> {
    let actions = table.num_actions();
    let mut values = vec![0.0; table.states()];
    let mut returns = values.clone();
    let (mut next_values, mut next_returns) = (values.clone(), values.clone());
    let mut row = vec![0.0; actions];
    let mut policy = vec![usize::MAX; table.states()];
    let mut changes = Vec::new();
    let mut sweeps = 0;
    let mut same = false;
    while sweeps < steps && !same {
        if stop.load(Ordering::Acquire) {
            return Err(PlanningError::Stopped);
        }
        sweeps += 1;
        for (state, kept) in policy.iter_mut().enumerate() {
            for (action, value) in row.iter_mut().enumerate() {
                *value = action_value(table, state, action, discount, &values);
            }
            let best = argmax(&row);
            if row.get(*kept).is_none_or(|&value| value < row[best]) {
                *kept = best;
                changes.push(PolicyChange { steps_to_go: sweeps, state, action: best });
            }
            next_values[state] = row[best];
            next_returns[state] = action_value(table, state, *kept, 1.0, &returns);
        }
        swap(&mut values, &mut next_values);
        swap(&mut returns, &mut next_returns);
        // Equal values make equal actions, and these equal values, however many steps are added.
        same = values == next_values && returns == next_returns;
    }
    // With all steps left the next state has one step fewer.
    let q_values = action_values(table, discount, &next_values);
    let expected_return = expected(table, &returns);
    Ok(FiniteHorizon { values, q_values, policy, changes, expected_return, sweeps })
}

/// What a policy that never changes returns on average within `steps` steps, without a discount.
///
/// # Errors
/// `Stopped` after `stop` was set.
///
/// # Panics
/// For a policy of another length than the states', or with an action outside the table.
pub fn policy_return(
    table: &TabularMdp,
    policy: &[usize],
    steps: u64,
    stop: &AtomicBool,
) -> Result<f64, PlanningError> {
    assert_eq!(policy.len(), table.states(), "a policy has an action for each state");
    let mut returns = vec![0.0; table.states()];
    let mut next = returns.clone();
    for _ in 0..steps {
        if stop.load(Ordering::Acquire) {
            return Err(PlanningError::Stopped);
        }
        for (state, &action) in policy.iter().enumerate() {
            next[state] = action_value(table, state, action, 1.0, &returns);
        }
        swap(&mut returns, &mut next);
        if returns == next {
            break;
        }
    }
    Ok(expected(table, &returns))
}

/// The mean over the first states, added from the left.
fn expected(table: &TabularMdp, values: &[f64]) -> f64 {
    table.initial().iter().zip(values).fold(0.0, |sum, (probability, value)| sum + probability * value)
}
