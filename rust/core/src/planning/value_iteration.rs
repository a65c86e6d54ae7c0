//! Value iteration: `V(s) ← max_a Σ p (r + γ V(s'))`, in place, until nothing changes (Sutton & Barto, 2nd ed., eq. 4.10).

use std::sync::atomic::AtomicBool;

use super::bellman::{action_values, best_value, first_maximum, settle};
use super::{Solution, Unsolved, ending};
use crate::env::Env;
use crate::envs::Tabular;

/// The best values from zero on, and a policy that has them.
///
/// Without a discount (1) many actions are as good as each other: the policy takes of them what ends soonest.
///
/// # Errors
/// `Unsettled` where values grow without an end, `Stopped` after `stop` was set.
pub fn value_iteration(table: &Tabular, discount: f64, stop: &AtomicBool) -> Result<Solution, Unsolved> {
    let mut values = vec![0.0; table.states()];
    let sweeps = settle(&mut values, stop, |state, values| best_value(table, state, discount, values))?;
    let q_values = action_values(table, discount, &values);
    let policy = if discount == 1.0 {
        ending::soonest(table, &values, &q_values, stop)?
    } else {
        q_values.chunks(table.actions()).map(first_maximum).collect()
    };
    Ok(Solution { values, q_values, policy, sweeps })
}
