//! Sweeps of dynamic programming over all states (Sutton & Barto, chapter 4): a single one, to show its steps, or as
//! many as the values need to settle.

use super::PlanningError;
use super::problem::Problem;
use super::stop_checks::StopChecks;
use crate::StopFlag;
use crate::envs::tabular::TabularMdp;
use crate::memory::collect;

/// A sweep has found the solution when it changes no value by more than this fraction of the magnitude of its terms:
/// the last bits.
const LAST_BITS: f64 = 4.0 * f64::EPSILON;

/// Replaces the value of each state by its update target: the expected one (equation 4.5) if `policy` holds π(a|s), the
/// actions of state 0 first, otherwise the largest one (equation 4.10).
///
/// In place, a state uses the new values of the states before it; otherwise the old values of all states.
///
/// # Errors
/// `Overflow`; `OutOfMemory`; `Stopped` after `stop` was set. The values are then those of an unfinished sweep.
///
/// # Panics
/// If `values` or `policy` does not fit the table.
pub fn sweep(
    mdp: &TabularMdp,
    policy: Option<&[f64]>,
    discount: f64,
    values: &mut [f64],
    in_place: bool,
    stop: &StopFlag<'_>,
) -> Result<(), PlanningError> {
    assert_eq!(values.len(), mdp.num_states(), "values must have a number for each state");
    let problem = Problem { mdp, discount, stop };
    let mut checks = problem.checks();
    let old: Vec<f64> = if in_place { Vec::new() } else { collect(values.iter().copied())? };
    for state in 0..values.len() {
        let from = if in_place { &*values } else { &old };
        values[state] = match policy {
            Some(policy) => problem.expected_value(policy, state, from),
            None => problem.best_value(state, from),
        };
        if !values[state].is_finite() {
            return Err(PlanningError::Overflow(state));
        }
        checks.state()?;
    }
    Ok(())
}

/// Sweeps over `count` states, with `order(sweep, index)` as the next one, and replaces each value in place, until the
/// changes are in the last bits of the terms and no longer shrink. `backup(state, values)` returns the new value and
/// the magnitude of its terms, which is read only if the value changes. Returns whether the values settled within
/// `most` sweeps.
///
/// # Errors
/// `Overflow`; `Stopped` after `stop` was set.
pub(super) fn converge(
    values: &mut [f64],
    count: usize,
    most: u64,
    mut checks: StopChecks<'_>,
    order: impl Fn(u64, usize) -> usize,
    backup: impl Fn(usize, &[f64]) -> (f64, f64),
) -> Result<bool, PlanningError> {
    let mut previous = f64::INFINITY;
    for sweep in 1..=most {
        let mut largest = 0.0_f64;
        for index in 0..count {
            let state = order(sweep, index);
            let (value, size) = backup(state, values);
            if !value.is_finite() {
                return Err(PlanningError::Overflow(state));
            }
            if value != values[state] {
                largest = largest.max((value - values[state]).abs() / size.clamp(f64::MIN_POSITIVE, f64::MAX));
                values[state] = value;
            }
            checks.state()?;
        }
        if largest == 0.0 || (largest <= LAST_BITS && largest >= previous) {
            return Ok(true);
        }
        previous = largest;
        checks.now()?;
    }
    Ok(false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::tabular::Outcome;

    /// Two states in a row with a reward of 1 for each step, followed by the end.
    fn corridor() -> TabularMdp {
        let step = |state, terminated| vec![Outcome { probability: 1.0, state, reward: 1.0, terminated }];
        TabularMdp::new(1, &[0.0, 1.0], &[step(0, true), step(0, false)]).expect("a valid table")
    }

    #[test]
    fn only_a_sweep_in_place_takes_new_values() {
        for policy in [None, Some([1.0, 1.0].as_slice())] {
            let (mut in_place, mut from_old) = ([0.0; 2], [0.0; 2]);
            sweep(&corridor(), policy, 0.5, &mut in_place, true, &StopFlag::new()).expect("not stopped");
            sweep(&corridor(), policy, 0.5, &mut from_old, false, &StopFlag::new()).expect("not stopped");
            assert_eq!((in_place, from_old), ([1.0, 1.5], [1.0, 1.0]));
        }
    }
}
