//! Value iteration: V(s) ← maxₐ Σ p (r + γ V(s′)), in place (Sutton & Barto, equation 4.10).

use super::Solution;
use super::best_policy::best_policy;
use super::endings::Endings;
use super::policy_iteration::improve;
use crate::StopFlag;
use crate::envs::tabular::TabularMdp;
use crate::memory::collect;
use crate::planning::problem::Problem;
use crate::planning::sweeps::converge;
use crate::planning::{MAX_SWEEPS, PlanningError};

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
    let problem = Problem { mdp, discount, stop };
    let endings = Endings::new(problem, true)?;
    let mut values = problem.zeros()?;
    let backup = |state: usize, values: &[f64]| {
        let value = problem.best_value(state, values);
        (value, if value == values[state] { 0.0 } else { problem.best_size(state, values) })
    };
    // Values that do not settle are replaced as well.
    converge(&mut values, mdp.num_states(), MAX_SWEEPS, problem.checks(), |_, state| state, backup)?;
    let q_values = problem.action_values(&values)?;
    let rough = collect(values.iter().map(|value| ROUGH * value.abs()))?;
    let greedy = best_policy(problem, &values, &rough, &q_values, &endings)?;
    let improved = match improve(problem, greedy, collect(values.iter().copied())?, &endings) {
        // No policy may have these values.
        Err(PlanningError::NoProperPolicy(_)) => {
            let proper = collect(endings.policy.iter().copied())?;
            improve(problem, proper, problem.zeros()?, &endings)?
        }
        improved => improved?,
    };
    let (policy, found) = improved.settled(problem, &endings)?;
    let pairs = values.iter().zip(found.values.iter().zip(&found.errors));
    if pairs.into_iter().all(|(value, (found, error))| (value - found).abs() <= AGREEMENT * error) {
        return Ok(Solution { values, q_values, policy });
    }
    let q_values = problem.action_values(&found.values)?;
    Ok(Solution { values: found.values, q_values, policy })
}
