//! Policies that end: without a discount only they have a value.

use std::sync::atomic::AtomicBool;

use super::PlanningError;
use super::bellman::{converge, tie_tolerance};
use crate::envs::tabular::TabularMdp;
use crate::envs::{Env, Step};
use crate::numeric::argmax;

/// What an end is worth a step later, where the soonest is looked for.
const STEP_DISCOUNT: f64 = 0.999;

/// For each state, of the actions that are best without a discount, the one that ends the episode soonest; the first
/// where none ends it. Many are as good as each other, and some of them lead round in circles for ever.
pub(crate) fn shortest(
    table: &TabularMdp,
    values: &[f64],
    q_values: &[f64],
    stop: &AtomicBool,
) -> Result<Vec<usize>, PlanningError> {
    let (actions, tie_tolerance) = (table.num_actions(), tie_tolerance(values));
    let worth = |state: usize, action: usize, ends: &[f64]| {
        if q_values[state * actions + action] < values[state] - tie_tolerance {
            return f64::NEG_INFINITY;
        }
        let end = |probability: f64, step: &Step<u32>| {
            probability * if step.terminated { 1.0 } else { STEP_DISCOUNT * ends[step.state as usize] }
        };
        table.outcomes(state, action).fold(0.0, |sum, (probability, step)| sum + end(probability, &step))
    };
    let mut ends = vec![0.0; table.states()];
    converge(&mut ends, stop, |state, ends| (0..actions).map(|action| worth(state, action, ends)).fold(0.0, f64::max))?;
    let best = |state: usize| {
        let worth: Vec<f64> = (0..actions).map(|action| worth(state, action, &ends)).collect();
        argmax(&worth)
    };
    Ok((0..table.states()).map(best).collect())
}

/// For each state one of the `allowed` actions that may end the episode, or lead to a state that has one; None where no
/// allowed action ever does. Whoever follows it ends with probability 1, or comes to where nothing ends.
pub(crate) fn proper_policy(table: &TabularMdp, allowed: impl Fn(usize, usize) -> bool) -> Vec<Option<usize>> {
    let mut chosen: Vec<Option<usize>> = vec![None; table.states()];
    let last = table.states() - 1;
    loop {
        let mut more = false;
        // There and back, so that a corridor takes no longer one way than the other.
        for state in (0..=last).chain((0..=last).rev()) {
            let leads = |&action: &usize| {
                allowed(state, action)
                    && table.outcomes(state, action).any(|(probability, step)| {
                        probability > 0.0 && (step.terminated || chosen[step.state as usize].is_some())
                    })
            };
            if chosen[state].is_none() {
                chosen[state] = (0..table.num_actions()).find(leads);
                more |= chosen[state].is_some();
            }
        }
        if !more {
            return chosen;
        }
    }
}
