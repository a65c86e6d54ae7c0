//! `Σ p (r + γ v(s'))`: the value of an action, which every method here is made of (Sutton & Barto, 2nd ed., eq. 4.6).

use std::sync::atomic::{AtomicBool, Ordering};

use super::PlanningError;
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;

/// Where values have not settled after so many sweeps, they are taken to grow for ever.
pub const MAX_SWEEPS: u64 = 200_000;
/// Values may have settled when a sweep changes none by more than this share of the largest: their last bits.
const CONVERGED: f64 = 4.0 * f64::EPSILON;
/// Two actions are equally good when their values differ by less than this share of the largest value. It is more
/// than what settled values are wrong by.
const EQUAL: f64 = 1e-10;

/// The value of an action, its outcomes added from the left. What comes after a terminal step counts nothing.
#[inline]
pub(crate) fn action_value(table: &TabularMdp, state: usize, action: usize, discount: f64, values: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (probability, step) in table.outcomes(state, action) {
        let next = if step.terminated { 0.0 } else { values[step.state as usize] };
        sum += probability * (step.reward + discount * next);
    }
    sum
}

/// The largest value of a state's actions.
#[inline]
pub(crate) fn best_value(table: &TabularMdp, state: usize, discount: f64, values: &[f64]) -> f64 {
    (0..table.num_actions())
        .map(|action| action_value(table, state, action, discount, values))
        .fold(f64::NEG_INFINITY, f64::max)
}

/// The values of all actions of all states.
pub(crate) fn action_values(table: &TabularMdp, discount: f64, values: &[f64]) -> Vec<f64> {
    (0..table.states())
        .flat_map(|state| {
            (0..table.num_actions()).map(move |action| action_value(table, state, action, discount, values))
        })
        .collect()
}

/// By how much an action must be better to count as better.
pub(crate) fn tie_tolerance(values: &[f64]) -> f64 {
    EQUAL * values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()))
}

/// Sweeps over the states, each value being replaced in its place, until the changes are in the last bits and shrink no
/// more; returns how many sweeps that took.
pub(crate) fn converge(
    values: &mut [f64],
    stop: &AtomicBool,
    mut backup: impl FnMut(usize, &[f64]) -> f64,
) -> Result<u64, PlanningError> {
    let mut before = f64::INFINITY;
    for sweeps in 1..=MAX_SWEEPS {
        let (mut change, mut largest) = (0.0_f64, 0.0_f64);
        for state in 0..values.len() {
            let value = backup(state, values);
            change = change.max((value - values[state]).abs());
            largest = largest.max(value.abs());
            values[state] = value;
        }
        if change == 0.0 || (change <= CONVERGED * largest && change >= before) {
            return Ok(sweeps);
        }
        before = change;
        if stop.load(Ordering::Acquire) {
            return Err(PlanningError::Stopped);
        }
    }
    Err(PlanningError::NotConverged)
}
