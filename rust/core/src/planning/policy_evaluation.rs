//! Policy evaluation: the values of a given policy (Sutton & Barto, section 4.1), and how often it visits each state
//! (section 9.2).

use crate::StopFlag;

use super::bellman::{action_values, choices, converge, expected_value};
use super::stop_checks::StopChecks;
use super::{MAX_SWEEPS, PlanningError};
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::filled;

/// The values of a policy.
#[derive(Clone, Debug, PartialEq)]
pub struct PolicyEvaluation {
    /// The value of each state: the expected discounted return.
    pub values: Vec<f64>,
    /// The value of each state-action pair, the actions of state 0 first.
    pub q_values: Vec<f64>,
    /// A bound of the error of every state value: the largest residual of the Bellman equation, or a rounding error if
    /// that is larger, times the largest expected number of (discounted) steps to the end.
    pub error: f64,
    /// The number of sweeps over all states.
    pub sweeps: u64,
}

/// The solution of v(s) = Σ π(a|s) Σ p (r + γ v(s′)) (equation 4.4), by sweeps in place. `policy` holds π(a|s), the actions
/// of state 0 first.
///
/// # Errors
/// Without discounting `NoProperPolicy` if from some state no episode ends and rewards are not 0; `NotConverged`;
/// `Stopped` after `stop` was set.
///
/// # Panics
/// If `policy` does not hold a number for each pair.
pub fn policy_evaluation(
    mdp: &TabularMdp,
    policy: &[f64],
    discount: f64,
    stop: &StopFlag<'_>,
) -> Result<PolicyEvaluation, PlanningError> {
    assert_eq!(policy.len(), mdp.num_states() * mdp.num_actions(), "policy must have a probability for each pair");
    let ends = can_end(mdp, policy, stop)?;
    let collects = |state: usize| {
        choices(mdp, policy, state)
            .any(|(action, _)| mdp.outcomes(state, action).any(|(probability, step)| probability * step.reward != 0.0))
    };
    if discount == 1.0
        && let Some(state) = (0..mdp.num_states()).find(|&state| !ends[state] && collects(state))
    {
        return Err(PlanningError::NoProperPolicy(state));
    }
    let backup = |state: usize, values: &[f64]| expected_value(mdp, policy, state, discount, values);
    let mut values = filled(&0.0, mdp.num_states(), stop)?;
    let sweeps = converge(&mut values, mdp, stop, backup)?;
    let (mut residual, mut largest) = (0.0_f64, 0.0_f64);
    for state in 0..mdp.num_states() {
        residual = residual.max((backup(state, &values) - values[state]).abs());
        largest = largest.max(values[state].abs());
    }
    let mut steps = filled(&0.0, mdp.num_states(), stop)?;
    converge(&mut steps, mdp, stop, |state, steps| {
        // Undiscounted values of states without an end are 0, without an error.
        if discount == 1.0 && !ends[state] {
            return 0.0;
        }
        choices(mdp, policy, state).fold(1.0, |sum, (action, probability)| {
            mdp.outcomes(state, action).fold(sum, |sum, (weight, step)| {
                let next = if step.terminated { 0.0 } else { steps[step.state as usize] };
                sum + probability * weight * discount * next
            })
        })
    })?;
    let longest = steps.iter().fold(1.0_f64, |longest, &steps| longest.max(steps));
    let q_values = action_values(mdp, discount, &values, stop)?;
    Ok(PolicyEvaluation { values, q_values, error: residual.max(f64::EPSILON * largest) * longest, sweeps })
}

/// The expected number of visits of each state in an episode, η(s) = h(s) + Σ η(s̄) Σ π(a|s̄) p(s|s̄, a) (equation 9.2).
///
/// # Errors
/// `NoProperPolicy` if an episode may never end; `NotConverged`; `Stopped` after `stop` was set.
///
/// # Panics
/// If `policy` does not hold a number for each pair.
pub fn expected_visits(mdp: &TabularMdp, policy: &[f64], stop: &StopFlag<'_>) -> Result<Vec<f64>, PlanningError> {
    assert_eq!(policy.len(), mdp.num_states() * mdp.num_actions(), "policy must have a probability for each pair");
    let ends = can_end(mdp, policy, stop)?;
    let mut checks = StopChecks::new(mdp, stop);
    // The visits at one time step, and at all so far.
    let mut current = mdp.initial_distribution().to_vec();
    let mut visits = filled(&0.0, mdp.num_states(), stop)?;
    for _ in 0..MAX_SWEEPS {
        let mut next = filled(&0.0, mdp.num_states(), stop)?;
        let mut changed = false;
        for (state, &here) in current.iter().enumerate().filter(|&(_, &here)| here > 0.0) {
            if !ends[state] {
                return Err(PlanningError::NoProperPolicy(state));
            }
            changed |= visits[state] + here != visits[state];
            visits[state] += here;
            for (action, probability) in choices(mdp, policy, state) {
                for (weight, step) in mdp.outcomes(state, action).filter(|(_, step)| !step.terminated) {
                    next[step.state as usize] += here * probability * weight;
                }
            }
            checks.state()?;
        }
        if !changed {
            return Ok(visits);
        }
        current = next;
    }
    Err(PlanningError::NotConverged)
}

/// From which states an episode can end under a policy.
fn can_end(mdp: &TabularMdp, policy: &[f64], stop: &StopFlag<'_>) -> Result<Vec<bool>, PlanningError> {
    let mut checks = StopChecks::new(mdp, stop);
    let mut ends = filled(&false, mdp.num_states(), stop)?;
    let mut forward = true;
    loop {
        let mut changed = false;
        for index in 0..ends.len() {
            // In both directions, so that long corridors take few sweeps.
            let state = if forward { index } else { ends.len() - 1 - index };
            if !ends[state] {
                ends[state] = choices(mdp, policy, state).any(|(action, _)| {
                    mdp.outcomes(state, action)
                        .any(|(probability, step)| probability > 0.0 && (step.terminated || ends[step.state as usize]))
                });
                changed |= ends[state];
            }
            checks.state()?;
        }
        if !changed {
            return Ok(ends);
        }
        forward = !forward;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::tabular::Outcome;

    /// A random walk over so many states, with a reward of 1 at the right end.
    fn walk(states: usize) -> TabularMdp {
        let step = |state: usize, right: bool| {
            let (end, next) =
                if right { (state + 1 == states, state + 1) } else { (state == 0, state.wrapping_sub(1)) };
            let reward = f64::from(u8::from(end && right));
            let state = if end { state } else { next };
            vec![Outcome { probability: 1.0, state: (state as u64).cast_signed(), reward, terminated: end }]
        };
        let pairs: Vec<_> = (0..states).flat_map(|state| [step(state, false), step(state, true)]).collect();
        let start: Vec<f64> = (0..states).map(|state| f64::from(u8::from(state == states / 2))).collect();
        TabularMdp::new(2, &start, &pairs).expect("a valid table")
    }

    #[test]
    fn the_random_walk_has_the_books_values() {
        let found = policy_evaluation(&walk(5), &[0.5; 10], 1.0, &StopFlag::new()).expect("proper");
        assert!(found.error < 1e-13, "{}", found.error);
        for (state, value) in found.values.iter().enumerate() {
            assert!((value - (state + 1) as f64 / 6.0).abs() <= found.error, "{:?}", found.values);
        }
    }

    #[test]
    fn a_random_walk_visits_its_middle_most() {
        let visits = expected_visits(&walk(5), &[0.5; 10], &StopFlag::new()).expect("proper");
        for (visits, expected) in visits.iter().zip([1.0, 2.0, 3.0, 2.0, 1.0]) {
            assert!((visits - expected).abs() < 1e-13, "{visits}");
        }
    }

    #[test]
    fn a_policy_that_never_ends_has_values_only_with_a_discount() {
        let stay = |reward| vec![Outcome { probability: 1.0, state: 0, reward, terminated: false }];
        let table = TabularMdp::new(1, &[1.0], &[stay(1.0)]).expect("a valid table");
        let stop = StopFlag::new();
        assert_eq!(policy_evaluation(&table, &[1.0], 1.0, &stop), Err(PlanningError::NoProperPolicy(0)));
        assert_eq!(expected_visits(&table, &[1.0], &stop), Err(PlanningError::NoProperPolicy(0)));
        let found = policy_evaluation(&table, &[1.0], 0.75, &stop).expect("discounted");
        assert!((found.values[0] - 4.0).abs() <= found.error);
        let idle = TabularMdp::new(1, &[1.0], &[stay(0.0)]).expect("a valid table");
        assert_eq!(policy_evaluation(&idle, &[1.0], 1.0, &stop).expect("no rewards").values, [0.0]);
    }
}
