//! Value iteration: `V(s) ← max_a Σ p (r + γ V(s'))`, in place, until nothing changes (Sutton & Barto, 2nd ed., eq. 4.10).

use std::sync::atomic::AtomicBool;

use super::bellman::{action_values, best_value, converge};
use super::proper_policy;
use super::{PlanningError, Solution};
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::numeric::argmax;

/// The best values from zero on, and a policy that has them.
///
/// Without a discount (1) many actions are as good as each other: the policy takes of them what ends soonest.
///
/// # Errors
/// `NotConverged` where values grow without an end, `Stopped` after `stop` was set.
pub fn value_iteration(table: &TabularMdp, discount: f64, stop: &AtomicBool) -> Result<Solution, PlanningError> {
    let mut values = vec![0.0; table.states()];
    let sweeps = converge(&mut values, stop, |state, values| best_value(table, state, discount, values))?;
    let q_values = action_values(table, discount, &values);
    let policy = if discount == 1.0 {
        proper_policy::shortest(table, &values, &q_values, stop)?
    } else {
        q_values.chunks(table.num_actions()).map(argmax).collect()
    };
    Ok(Solution { values, q_values, policy, sweeps })
}
