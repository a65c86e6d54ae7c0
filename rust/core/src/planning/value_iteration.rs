//! Value iteration: `V(s) ← max_a Σ p (r + γ V(s'))`, in place, until nothing changes (Sutton & Barto, 2nd ed., eq. 4.10).

use std::sync::atomic::AtomicBool;

use super::bellman::{action_values, best_value, first_maximum, margin, settle};
use super::{Solution, Unsolved, ending};
use crate::env::Env;
use crate::envs::Tabular;

/// The best values from zero on, and a policy that has them.
///
/// Without a discount (1) many actions are as good as each other, and some of them lead round in circles: the policy
/// then takes of the best actions one that comes nearer to an end, where one does.
///
/// # Errors
/// `Unsettled` where values grow without an end, `Stopped` after `stop` was set.
pub fn value_iteration(table: &Tabular, discount: f64, stop: &AtomicBool) -> Result<Solution, Unsolved> {
    let mut values = vec![0.0; table.states()];
    let sweeps = settle(&mut values, stop, |state, values| best_value(table, state, discount, values))?;
    let q_values = action_values(table, discount, &values);
    let actions = table.actions();
    let mut policy: Vec<usize> = q_values.chunks(actions).map(first_maximum).collect();
    if discount == 1.0 {
        let margin = margin(&values);
        let best = |state: usize, action: usize| q_values[state * actions + action] >= values[state] - margin;
        for (action, towards) in policy.iter_mut().zip(ending::towards(table, best)) {
            *action = towards.unwrap_or(*action);
        }
    }
    Ok(Solution { values, q_values, policy, sweeps })
}
