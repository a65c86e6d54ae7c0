//! Value iteration: V(s) ← maxₐ Σ p (r + γ V(s′)), in place (Sutton & Barto, equation 4.10).

use crate::StopFlag;

use super::bellman::{action_values, best_value, converge};
use super::{PlanningError, Solution, proper_policy};
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::{collect, filled};
use crate::numeric::argmax;

/// The optimal values, iterated from 0, and a greedy policy.
///
/// Without discounting (`discount == 1`), several actions can tie: the policy then takes the one that ends the episode
/// soonest.
///
/// # Errors
/// `NotConverged` if values grow without bound; `Stopped` after `stop` was set.
pub fn value_iteration(mdp: &TabularMdp, discount: f64, stop: &StopFlag<'_>) -> Result<Solution, PlanningError> {
    let mut values = filled(&0.0, mdp.num_states(), stop)?;
    let sweeps = converge(&mut values, mdp, stop, |state, values| best_value(mdp, state, discount, values))?;
    let q_values = action_values(mdp, discount, &values, stop)?;
    let policy = if discount == 1.0 {
        proper_policy::shortest(mdp, &values, &q_values, stop)?
    } else {
        collect(q_values.chunks(mdp.num_actions()).map(argmax))?
    };
    Ok(Solution { values, q_values, policy, sweeps })
}
