//! Policy iteration: evaluate, improve, until no action is better (Sutton & Barto, 2nd ed., section 4.3).

use std::sync::atomic::AtomicBool;

use super::bellman::{action_value, action_values, converge, tie_tolerance};
use super::proper_policy;
use super::{PlanningError, Solution};
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::numeric::argmax;

/// The best policy, and its values. An action is left only for one that is better by more than rounding, so that
/// equally good policies are not exchanged for ever (the book's exercise 4.4).
///
/// Without a discount (1) it is the best of the policies that end: it begins with one, and an improvement of a policy
/// that ends is one again, or it has found rewards without an end (Bertsekas & Tsitsiklis, 1991). States from which
/// nothing ends and every reward is zero, such as walls, are worth zero.
///
/// # Errors
/// `NoProperPolicy` and `UnboundedReturn` without a discount; `NotConverged`, `Stopped`.
pub fn policy_iteration(table: &TabularMdp, discount: f64, stop: &AtomicBool) -> Result<Solution, PlanningError> {
    let actions = table.num_actions();
    let towards_end = proper_policy::proper_policy(table, |_, _| true);
    if let (true, Some(state)) = (discount == 1.0, lost(table, &towards_end)) {
        return Err(PlanningError::NoProperPolicy(state));
    }
    let mut policy: Vec<usize> = towards_end.iter().map(|action| action.unwrap_or(0)).collect();
    let mut values = vec![0.0; table.states()];
    let mut sweeps = 0;
    loop {
        sweeps +=
            converge(&mut values, stop, |state, values| action_value(table, state, policy[state], discount, values))?;
        let q_values = action_values(table, discount, &values);
        let tie_tolerance = tie_tolerance(&values);
        let mut stable = true;
        for (state, row) in q_values.chunks(actions).enumerate() {
            let best = argmax(row);
            if row[best] > row[policy[state]] + tie_tolerance {
                policy[state] = best;
                stable = false;
            }
        }
        if stable {
            if discount == 1.0 {
                policy = proper_policy::shortest(table, &values, &q_values, stop)?;
            }
            return Ok(Solution { values, q_values, policy, sweeps });
        }
        if discount == 1.0 {
            let ends = proper_policy::proper_policy(table, |state, action| policy[state] == action);
            if let Some(state) =
                (0..table.states()).find(|&state| towards_end[state].is_some() && ends[state].is_none())
            {
                return Err(PlanningError::UnboundedReturn(state));
            }
        }
    }
}

/// A state from which nothing ends and not every reward is zero.
fn lost(table: &TabularMdp, towards_end: &[Option<usize>]) -> Option<usize> {
    let counts = |state: usize, action: usize| {
        table.outcomes(state, action).any(|(probability, step)| probability * step.reward != 0.0)
    };
    (0..table.states())
        .find(|&state| towards_end[state].is_none() && (0..table.num_actions()).any(|action| counts(state, action)))
}
