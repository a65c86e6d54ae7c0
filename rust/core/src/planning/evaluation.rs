//! The values of the policy behind a Markov chain, and how far rounding may have moved them.

use crate::StopFlag;

use super::PlanningError;
use super::markov_chain::MarkovChain;
use crate::memory::with_capacity;

/// The values of a policy.
#[derive(Clone, Debug)]
pub(super) struct Evaluation {
    pub(super) values: Vec<f64>,
    /// A bound of the error of each value. It depends only on the states that can follow, so that values which are large
    /// elsewhere do not matter.
    pub(super) errors: Vec<f64>,
    pub(super) sweeps: u64,
}

/// Evaluates the policy of a chain in all states, beginning with `guess`.
///
/// # Errors
/// As [`solve`].
pub(super) fn evaluate(
    chain: &MarkovChain,
    discount: f64,
    guess: Vec<f64>,
    stop: &StopFlag<'_>,
) -> Result<Evaluation, PlanningError> {
    let mut states = with_capacity(chain.num_states())?;
    states.extend(0..chain.num_states());
    let (mut values, mut unknown) = (guess, states);
    let sweeps = solve(chain, discount, &mut unknown, &mut values, stop)?;
    let errors = chain.errors(&unknown, &values, stop)?;
    Ok(Evaluation { values, errors, sweeps })
}

/// Replaces a first guess of the values of some states, which are not left, by the values. Returns the number of sweeps.
///
/// Without discounting, states that never leave each other and collect no reward have the value 0, and leave the list.
///
/// # Errors
/// Without discounting `NoProperPolicy` if the policy collects rewards forever; `NotConverged`; `Overflow`;
/// `OutOfMemory`; `Stopped` after `stop` was set.
pub(super) fn solve(
    chain: &MarkovChain,
    discount: f64,
    states: &mut Vec<usize>,
    values: &mut [f64],
    stop: &StopFlag<'_>,
) -> Result<u64, PlanningError> {
    if discount == 1.0 {
        let staying = chain.staying(stop)?;
        let settles = chain.reaching(&staying, stop)?;
        if let Some(&state) = states.iter().find(|&&state| !settles[state]) {
            return Err(PlanningError::NoProperPolicy(state));
        }
        for (value, _) in values.iter_mut().zip(&staying).filter(|&(_, &staying)| staying) {
            *value = 0.0;
        }
        states.retain(|&state| !staying[state]);
    }
    chain.solve(states, &chain.rewards, values, stop)
}
