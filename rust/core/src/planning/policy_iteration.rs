//! Policy iteration: evaluate and improve a policy until no action is better (Sutton & Barto, section 4.3).

use crate::StopFlag;

use super::bellman::{action_value, action_values, converge, tie_tolerance};
use super::{PlanningError, Solution, proper_policy};
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::{collect, filled};
use crate::numeric::argmax;

/// An optimal policy and its values. An action is replaced only by one that is better by more than rounding errors, so
/// that equally good policies do not alternate forever (the book's exercise 4.4).
///
/// Without discounting (`discount == 1`) the policy is the best proper one, that is, among those that end every episode.
/// The first policy is proper, and an improvement of a proper policy is proper too, or has an unbounded return
/// (D. Bertsekas and J. Tsitsiklis, "An analysis of stochastic shortest path problems", 1991). States that no policy can
/// leave and whose rewards are 0, such as walls, have the value 0.
///
/// # Errors
/// Without discounting `NoProperPolicy` and `UnboundedReturn`; `NotConverged`; `Stopped` after `stop` was set.
pub fn policy_iteration(mdp: &TabularMdp, discount: f64, stop: &StopFlag<'_>) -> Result<Solution, PlanningError> {
    let num_actions = mdp.num_actions();
    let proper = proper_policy::proper_policy(mdp, stop, |_, _| true)?;
    if let (true, Some(state)) = (discount == 1.0, endless_state(mdp, &proper)) {
        return Err(PlanningError::NoProperPolicy(state));
    }
    let mut policy: Vec<usize> = collect(proper.iter().map(|action| action.unwrap_or(0)))?;
    let mut values = filled(&0.0, mdp.num_states(), stop)?;
    let mut sweeps = 0;
    loop {
        sweeps += converge(&mut values, mdp, stop, |state, values| {
            action_value(mdp, state, policy[state], discount, values)
        })?;
        let q_values = action_values(mdp, discount, &values, stop)?;
        let tie_tolerance = tie_tolerance(&values);
        let mut stable = true;
        for (state, row) in q_values.chunks(num_actions).enumerate() {
            let best = argmax(row);
            if row[best] > row[policy[state]] + tie_tolerance {
                policy[state] = best;
                stable = false;
            }
        }
        if stable {
            if discount == 1.0 {
                policy = proper_policy::shortest(mdp, &values, &q_values, stop)?;
            }
            return Ok(Solution { values, q_values, policy, sweeps });
        }
        if discount == 1.0 {
            let ends = proper_policy::proper_policy(mdp, stop, |state, action| policy[state] == action)?;
            if let Some(state) = (0..mdp.num_states()).find(|&state| proper[state].is_some() && ends[state].is_none()) {
                return Err(PlanningError::UnboundedReturn(state));
            }
        }
    }
}

/// A state from which no episode ends and not every reward is 0.
fn endless_state(mdp: &TabularMdp, proper: &[Option<usize>]) -> Option<usize> {
    let has_reward = |state: usize, action: usize| {
        mdp.outcomes(state, action).any(|(probability, step)| probability * step.reward != 0.0)
    };
    (0..mdp.num_states())
        .find(|&state| proper[state].is_none() && (0..mdp.num_actions()).any(|action| has_reward(state, action)))
}
