//! Value iteration: V(s) ← maxₐ Σ p (r + γ V(s′)), in place (Sutton & Barto, equation 4.10).

use std::sync::atomic::AtomicBool;

use super::bellman::{action_values, best_value, converge};
use super::{PlanningError, Solution, proper_policy};
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::numeric::argmax;

/// The optimal values, iterated from 0, and a greedy policy.
///
/// Without discounting (`discount == 1`), several actions can tie: the policy then takes the one that ends the episode
/// soonest.
///
/// # Errors
/// `NotConverged` if values grow without bound; `Stopped` after `stop` was set.
pub fn value_iteration(mdp: &TabularMdp, discount: f64, stop: &AtomicBool) -> Result<Solution, PlanningError> {
    let mut values = vec![0.0; mdp.num_states()];
    let sweeps = converge(&mut values, stop, |state, values| best_value(mdp, state, discount, values))?;
    let q_values = action_values(mdp, discount, &values);
    let policy = if discount == 1.0 {
        proper_policy::shortest(mdp, &values, &q_values, stop)?
    } else {
        q_values.chunks(mdp.num_actions()).map(argmax).collect()
    };
    Ok(Solution { values, q_values, policy, sweeps })
}
