//! Value iteration: V(s) ← maxₐ Σ p (r + γ V(s′)), in place (Sutton & Barto, equation 4.10).

use crate::StopFlag;

use super::bellman::{action_values, best_size, best_value};
use super::best_policy::best_policy;
use super::endings::Endings;
use super::policy_iteration::improve;
use super::stop_checks::StopChecks;
use super::sweeps::converge;
use super::{MAX_SWEEPS, PlanningError, Solution};
use crate::envs::tabular::TabularMdp;
use crate::memory::{collect, filled};

/// The relative error of values found by sweeps, before their policy is evaluated.
const ROUGH: f64 = 1e-10;
/// Values agree if they differ by less than this multiple of the bound on the rounding errors.
const AGREEMENT: f64 = 4.0;

/// The optimal values, iterated from 0, and an optimal policy.
///
/// The policy is evaluated. Values that differ from the policy's are replaced: without discounting, sweeps can end at a
/// solution of the Bellman equation that no policy achieves, and with a discount close to 1 they can take too long.
///
/// Without discounting (`discount == 1`), policies that stay forever in states without rewards are also considered. If
/// several actions tie, the policy takes the one on the shortest way to the end.
///
/// # Errors
/// As [`super::policy_iteration()`].
pub fn value_iteration(mdp: &TabularMdp, discount: f64, stop: &StopFlag<'_>) -> Result<Solution, PlanningError> {
    let endings = Endings::for_discount(mdp, discount, true, stop)?;
    let mut values = filled(&0.0, mdp.num_states(), stop)?;
    let backup = |state: usize, values: &[f64]| {
        let value = best_value(mdp, state, discount, values);
        (value, if value == values[state] { 0.0 } else { best_size(mdp, state, discount, values) })
    };
    // Values that do not settle are replaced as well.
    converge(&mut values, mdp.num_states(), MAX_SWEEPS, StopChecks::new(mdp, stop), |_, state| state, backup)?;
    let q_values = action_values(mdp, discount, &values, stop)?;
    let rough = collect(values.iter().map(|value| ROUGH * value.abs()))?;
    let greedy = best_policy(mdp, discount, &values, &rough, &q_values, &endings, stop)?;
    let improved = match improve(mdp, discount, greedy, collect(values.iter().copied())?, &endings, stop) {
        // No policy may have these values.
        Err(PlanningError::NoProperPolicy(_)) => {
            let proper = collect(endings.policy.iter().copied())?;
            improve(mdp, discount, proper, filled(&0.0, mdp.num_states(), stop)?, &endings, stop)?
        }
        improved => improved?,
    };
    let (policy, found) = improved.settled(mdp, discount, &endings, stop)?;
    let pairs = values.iter().zip(found.values.iter().zip(&found.errors));
    if pairs.into_iter().all(|(value, (found, error))| (value - found).abs() <= AGREEMENT * error) {
        return Ok(Solution { values, q_values, policy });
    }
    let q_values = action_values(mdp, discount, &found.values, stop)?;
    Ok(Solution { values: found.values, q_values, policy })
}
