//! The choice among equally good policies.

use crate::StopFlag;

use super::bellman::action_error;
use super::endings::Endings;
use super::stop_checks::StopChecks;
use super::sweeps::converge;
use super::{MAX_SWEEPS, PlanningError};
use crate::envs::tabular::TabularMdp;
use crate::envs::{Env, Step};
use crate::memory::{collect, filled};
use crate::numeric::{argmax, maximum};

/// The discount per step on ending an episode, so that ending earlier is better.
const STEP_DISCOUNT: f64 = 0.999;
/// Two actions end an episode equally soon if the discounted probabilities differ by less than this fraction.
const EQUALLY_SOON: f64 = 1e-9;

/// The first optimal action of each state. Without discounting, only actions on a shortest way to the end count or, if
/// none ends the episode, to a state in which to stay without a reward: many actions can be optimal, and some lead
/// around in circles forever. Actions are optimal unless they are worse by more than rounding errors, which `errors`
/// bounds for each value.
pub(super) fn best_policy(
    mdp: &TabularMdp,
    discount: f64,
    values: &[f64],
    errors: &[f64],
    q_values: &[f64],
    endings: &Endings,
    stop: &StopFlag<'_>,
) -> Result<Vec<usize>, PlanningError> {
    let optimal = optimal_actions(mdp, discount, values, errors, q_values, stop)?;
    if discount < 1.0 {
        let rows = optimal.chunks(mdp.num_actions());
        return Ok(collect(rows.map(|row| row.iter().position(|&optimal| optimal).unwrap_or(0)))?);
    }
    let ending = shortest_way(mdp, &optimal, stop, |_| None)?;
    if let Some(ending) = ending.iter().copied().collect() {
        return Ok(ending);
    }
    let staying = shortest_way(mdp, &optimal, stop, |state| {
        let is_optimal = |&action: &usize| optimal[state * mdp.num_actions() + action];
        endings.staying_action(state).filter(is_optimal).filter(|_| values[state].abs() <= errors[state])
    })?;
    let actions = ending.iter().zip(&staying).zip(&endings.policy);
    Ok(collect(actions.map(|((&ending, &staying), &policy)| ending.or(staying).unwrap_or(policy)))?)
}

/// Whether each state-action pair is optimal, the actions of state 0 first.
fn optimal_actions(
    mdp: &TabularMdp,
    discount: f64,
    values: &[f64],
    errors: &[f64],
    q_values: &[f64],
    stop: &StopFlag<'_>,
) -> Result<Vec<bool>, PlanningError> {
    let mut optimal = filled(&false, q_values.len(), stop)?;
    let mut checks = StopChecks::new(mdp, stop);
    let rows = q_values.chunks(mdp.num_actions()).zip(optimal.chunks_mut(mdp.num_actions()));
    for (state, (row, optimal)) in rows.enumerate() {
        let error_of = |action| action_error(mdp, state, action, discount, values, errors);
        let best = argmax(row);
        let best_error = error_of(best);
        for (action, optimal) in optimal.iter_mut().enumerate() {
            *optimal = row[best] - row[action] <= best_error + error_of(action);
        }
        checks.state()?;
    }
    Ok(optimal)
}

/// For each state the optimal action on a shortest way to the end, or to a state for which `goal_action` has an action,
/// which that state takes; `None` if no optimal action leads there.
fn shortest_way(
    mdp: &TabularMdp,
    optimal: &[bool],
    stop: &StopFlag<'_>,
    goal_action: impl Fn(usize) -> Option<usize>,
) -> Result<Vec<Option<usize>>, PlanningError> {
    let num_actions = mdp.num_actions();
    // The discounted probability of ending the episode or reaching a goal.
    let ending_value = |state: usize, action: usize, ending_values: &[f64]| {
        if !optimal[state * num_actions + action] {
            return 0.0;
        }
        let outcome_value = |probability: f64, step: &Step<u32>| {
            probability * if step.terminated { 1.0 } else { STEP_DISCOUNT * ending_values[step.state as usize] }
        };
        mdp.outcomes(state, action).fold(0.0, |sum, (probability, step)| sum + outcome_value(probability, &step))
    };
    let best_ending_value = |state: usize, ending_values: &[f64]| {
        let best = match goal_action(state) {
            Some(_) => 1.0,
            None => (0..num_actions).map(|action| ending_value(state, action, ending_values)).fold(0.0, f64::max),
        };
        (best, best)
    };
    let (count, checks) = (mdp.num_states(), StopChecks::new(mdp, stop));
    let mut ending_values = filled(&0.0, count, stop)?;
    if !converge(&mut ending_values, count, MAX_SWEEPS, checks, |_, state| state, best_ending_value)? {
        return Err(PlanningError::NotConverged { sweeps: MAX_SWEEPS });
    }
    let mut checks = StopChecks::new(mdp, stop);
    let (mut policy, mut row) = (filled(&None, mdp.num_states(), stop)?, filled(&0.0, num_actions, stop)?);
    for (state, chosen) in policy.iter_mut().enumerate() {
        for (action, value) in row.iter_mut().enumerate() {
            *value = ending_value(state, action, &ending_values);
        }
        let soonest = maximum(&row);
        *chosen = goal_action(state)
            .or_else(|| row.iter().position(|&value| value > 0.0 && value >= (1.0 - EQUALLY_SOON) * soonest));
        checks.state()?;
    }
    Ok(policy)
}
