//! Policy iteration: evaluate, improve, until no action is better (Sutton & Barto, 2nd ed., section 4.3).

use std::sync::atomic::AtomicBool;

use super::bellman::{action_value, action_values, first_maximum, margin, settle};
use super::{Solution, Unsolved, ending};
use crate::env::Env;
use crate::envs::Tabular;

/// The best policy, and its values. An action is left only for one that is better by more than rounding, so that
/// equally good policies are not exchanged for ever (the book's exercise 4.4).
///
/// Without a discount (1) it is the best of the policies that end: it begins with one, and an improvement of a policy
/// that ends is one again, or it has found rewards without an end (Bertsekas & Tsitsiklis, 1991). States from which
/// nothing ends and every reward is zero, such as walls, are worth zero.
///
/// # Errors
/// `NeverEnds` and `Endless` without a discount; `Unsettled`, `Stopped`.
pub fn policy_iteration(table: &Tabular, discount: f64, stop: &AtomicBool) -> Result<Solution, Unsolved> {
    let actions = table.actions();
    let mut policy = if discount == 1.0 { one_that_ends(table)? } else { vec![0; table.states()] };
    let walled: Vec<bool> = ending::towards(table, |_, _| true).iter().map(Option::is_none).collect();
    let mut values = vec![0.0; table.states()];
    let mut sweeps = 0;
    loop {
        sweeps +=
            settle(&mut values, stop, |state, values| action_value(table, state, policy[state], discount, values))?;
        let q_values = action_values(table, discount, &values);
        let margin = margin(&values);
        let mut stable = true;
        for (state, row) in q_values.chunks(actions).enumerate() {
            let best = first_maximum(row);
            if row[best] > row[policy[state]] + margin {
                policy[state] = best;
                stable = false;
            }
        }
        if stable {
            if discount == 1.0 {
                policy = ending::soonest(table, &values, &q_values, stop)?;
            }
            return Ok(Solution { values, q_values, policy, sweeps });
        }
        if discount == 1.0 {
            let ends = ending::towards(table, |state, action| policy[state] == action);
            if let Some(state) = (0..table.states()).find(|&state| !walled[state] && ends[state].is_none()) {
                return Err(Unsolved::Endless(state));
            }
        }
    }
}

/// A policy that ends wherever one does.
fn one_that_ends(table: &Tabular) -> Result<Vec<usize>, Unsolved> {
    let towards = ending::towards(table, |_, _| true);
    let lost = |state: usize| {
        towards[state].is_none()
            && (0..table.actions())
                .any(|action| table.outcomes(state, action).any(|(probability, step)| probability * step.reward != 0.0))
    };
    match (0..table.states()).find(|&state| lost(state)) {
        Some(state) => Err(Unsolved::NeverEnds(state)),
        None => Ok(towards.into_iter().map(|action| action.unwrap_or(0)).collect()),
    }
}
