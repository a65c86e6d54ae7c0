//! The choice among equally good policies.

use super::endings::Endings;
use crate::envs::{Env, Step};
use crate::memory::{collect, filled};
use crate::numeric::{argmax, maximum};
use crate::planning::problem::Problem;
use crate::planning::sweeps::converge;
use crate::planning::{MAX_SWEEPS, PlanningError};

/// The discount per step on ending an episode, so that ending earlier is better.
const STEP_DISCOUNT: f64 = 0.999;
/// Two actions end an episode equally soon if the discounted probabilities differ by less than this fraction.
const EQUALLY_SOON: f64 = 1e-9;

/// The first optimal action of each state. Without discounting, only actions on a shortest way to the end count or, if
/// none ends the episode, to a state in which to stay without a reward: many actions can be optimal, and some lead
/// around in circles forever. Actions are optimal unless they are worse by more than rounding errors, which `errors`
/// bounds for each value.
pub(super) fn best_policy(
    problem: Problem<'_>,
    values: &[f64],
    errors: &[f64],
    q_values: &[f64],
    endings: &Endings,
) -> Result<Vec<usize>, PlanningError> {
    let mdp = problem.mdp;
    let optimal = optimal_actions(problem, values, errors, q_values)?;
    if problem.discount < 1.0 {
        let rows = optimal.chunks(mdp.num_actions());
        return Ok(collect(rows.map(|row| row.iter().position(|&optimal| optimal).unwrap_or(0)))?);
    }
    let ending = shortest_way(problem, &optimal, |_| None)?;
    if let Some(ending) = ending.iter().copied().collect() {
        return Ok(ending);
    }
    let staying = shortest_way(problem, &optimal, |state| {
        let is_optimal = |&action: &usize| optimal[state * mdp.num_actions() + action];
        endings.staying_action(state).filter(is_optimal).filter(|_| values[state].abs() <= errors[state])
    })?;
    let actions = ending.iter().zip(&staying).zip(&endings.policy);
    Ok(collect(actions.map(|((&ending, &staying), &policy)| ending.or(staying).unwrap_or(policy)))?)
}

/// Whether each state-action pair is optimal, the actions of state 0 first.
fn optimal_actions(
    problem: Problem<'_>,
    values: &[f64],
    errors: &[f64],
    q_values: &[f64],
) -> Result<Vec<bool>, PlanningError> {
    let (mut checks, num_actions) = (problem.checks(), problem.mdp.num_actions());
    let mut optimal = filled(&false, q_values.len(), problem.stop)?;
    let rows = q_values.chunks(num_actions).zip(optimal.chunks_mut(num_actions));
    for (state, (row, optimal)) in rows.enumerate() {
        let error_of = |action| problem.action_error(state, action, values, errors);
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
    problem: Problem<'_>,
    optimal: &[bool],
    goal_action: impl Fn(usize) -> Option<usize>,
) -> Result<Vec<Option<usize>>, PlanningError> {
    let Problem { mdp, stop, .. } = problem;
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
    let (count, mut ending_values) = (mdp.num_states(), problem.zeros()?);
    if !converge(&mut ending_values, count, MAX_SWEEPS, problem.checks(), |_, state| state, best_ending_value)? {
        return Err(PlanningError::NotConverged { sweeps: MAX_SWEEPS });
    }
    let mut checks = problem.checks();
    let (mut policy, mut row) = (filled(&None, count, stop)?, filled(&0.0, num_actions, stop)?);
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
