//! Proper policies, which end every episode. Without discounting only they have finite values.

use crate::StopFlag;

use super::PlanningError;
use super::bellman::{converge, tie_tolerance};
use super::stop_checks::StopChecks;
use crate::envs::tabular::TabularMdp;
use crate::envs::{Env, Step};
use crate::memory::{filled, with_capacity};
use crate::numeric::argmax;

/// The discount per step on ending an episode, so that ending sooner is better.
const STEP_DISCOUNT: f64 = 0.999;

/// For each state the action that ends the episode soonest among the optimal ones without discounting, or the first
/// optimal action if none ends it. Many actions can be optimal, and some of them lead around in circles forever.
pub(super) fn shortest(
    mdp: &TabularMdp,
    values: &[f64],
    q_values: &[f64],
    stop: &StopFlag<'_>,
) -> Result<Vec<usize>, PlanningError> {
    let (num_actions, tie_tolerance) = (mdp.num_actions(), tie_tolerance(values));
    // The discounted probability of ending the episode; -∞ if the action is not optimal.
    let ending_value = |state: usize, action: usize, ending_values: &[f64]| {
        if q_values[state * num_actions + action] < values[state] - tie_tolerance {
            return f64::NEG_INFINITY;
        }
        let outcome_value = |probability: f64, step: &Step<u32>| {
            probability * if step.terminated { 1.0 } else { STEP_DISCOUNT * ending_values[step.state as usize] }
        };
        mdp.outcomes(state, action).fold(0.0, |sum, (probability, step)| sum + outcome_value(probability, &step))
    };
    let mut ending_values = filled(&0.0, mdp.num_states(), stop)?;
    converge(&mut ending_values, mdp, stop, |state, ending_values| {
        (0..num_actions).map(|action| ending_value(state, action, ending_values)).fold(0.0, f64::max)
    })?;
    let mut checks = StopChecks::new(mdp, stop);
    let (mut policy, mut row) = (with_capacity(mdp.num_states())?, filled(&0.0, num_actions, stop)?);
    for state in 0..mdp.num_states() {
        for (action, value) in row.iter_mut().enumerate() {
            *value = ending_value(state, action, &ending_values);
        }
        policy.push(argmax(&row));
        checks.state()?;
    }
    Ok(policy)
}

/// For each state an allowed action that may end the episode or lead to a state that has such an action; `None` if no
/// allowed action does. Following it ends the episode with probability 1, or reaches a state from which nothing ends it.
pub(super) fn proper_policy(
    mdp: &TabularMdp,
    stop: &StopFlag<'_>,
    allowed: impl Fn(usize, usize) -> bool,
) -> Result<Vec<Option<usize>>, PlanningError> {
    let mut checks = StopChecks::new(mdp, stop);
    let mut policy: Vec<Option<usize>> = filled(&None, mdp.num_states(), stop)?;
    let last = mdp.num_states() - 1;
    loop {
        let mut changed = false;
        // Forwards and backwards, so that a corridor takes as few sweeps in either direction.
        for state in (0..=last).chain((0..=last).rev()) {
            let may_end = |&action: &usize| {
                allowed(state, action)
                    && mdp.outcomes(state, action).any(|(probability, step)| {
                        probability > 0.0 && (step.terminated || policy[step.state as usize].is_some())
                    })
            };
            if policy[state].is_none() {
                policy[state] = (0..mdp.num_actions()).find(may_end);
                changed |= policy[state].is_some();
            }
            checks.state()?;
        }
        if !changed {
            return Ok(policy);
        }
    }
}
