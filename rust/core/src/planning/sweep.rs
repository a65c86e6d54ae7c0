//! One sweep of dynamic programming over all states, for those who look at its steps (Sutton & Barto, chapter 4).

use crate::StopFlag;

use super::PlanningError;
use super::bellman::{best_value, expected_value};
use super::stop_checks::StopChecks;
use crate::envs::tabular::TabularMdp;
use crate::memory::collect;

/// Replaces the value of each state by its update target: with `policy`, which holds π(a|s), the actions of state 0 first,
/// the expected one (equation 4.5), otherwise the largest one (equation 4.10).
///
/// In place, a state takes the new values of the states before it; otherwise the old values of all states.
///
/// # Errors
/// `Overflow`; `OutOfMemory`; `Stopped` after `stop` was set. The values are then those of an unfinished sweep.
///
/// # Panics
/// If `values` or `policy` has another length than the table.
pub fn sweep(
    mdp: &TabularMdp,
    policy: Option<&[f64]>,
    discount: f64,
    values: &mut [f64],
    in_place: bool,
    stop: &StopFlag<'_>,
) -> Result<(), PlanningError> {
    assert_eq!(values.len(), mdp.num_states(), "values must have a number for each state");
    let mut checks = StopChecks::new(mdp, stop);
    let old: Vec<f64> = if in_place { Vec::new() } else { collect(values.iter().copied())? };
    for state in 0..values.len() {
        let from = if in_place { &*values } else { &old };
        values[state] = match policy {
            Some(policy) => expected_value(mdp, policy, state, discount, from),
            None => best_value(mdp, state, discount, from),
        };
        if !values[state].is_finite() {
            return Err(PlanningError::Overflow(state));
        }
        checks.state()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::tabular::Outcome;

    /// Two states in a row with a reward of 1 for each step, and the end behind them.
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
