//! Policy evaluation: the values of a given policy (Sutton & Barto, section 4.1), and how often it visits each state
//! (section 9.2).

use crate::StopFlag;

use super::PlanningError;
use super::bellman::{action_values, choices};
use super::evaluation::{Evaluation, evaluate};
use super::markov_chain::MarkovChain;
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
    /// A bound of the error of every state value: the largest expected (discounted) sum, over the steps to the end, of
    /// what is left of the Bellman equation and of the rounding errors.
    pub error: f64,
    /// The number of sweeps over all states.
    pub sweeps: u64,
}

/// The solution of v(s) = Σ π(a|s) Σ p (r + γ v(s′)) (equation 4.4), by sweeps in place, or directly where these take long.
/// `policy` holds π(a|s), the actions of state 0 first. Without discounting, states that never leave each other and
/// collect no reward have the value 0.
///
/// # Errors
/// Without discounting `NoProperPolicy` if from some state the policy collects rewards forever; `NotConverged`;
/// `Overflow`; `OutOfMemory`; `Stopped` after `stop` was set.
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
    let chain = MarkovChain::new(mdp, discount, stop, |state| choices(mdp, policy, state))?;
    let Evaluation { values, errors, sweeps } =
        evaluate(&chain, discount, filled(&0.0, mdp.num_states(), stop)?, stop)?;
    let q_values = action_values(mdp, discount, &values, stop)?;
    let error = errors.iter().fold(0.0, |largest: f64, &error| largest.max(error));
    Ok(PolicyEvaluation { values, q_values, error, sweeps })
}

/// The expected number of visits of each state in an episode, η(s) = h(s) + Σ η(s̄) Σ π(a|s̄) p(s|s̄, a) (equation 9.2).
///
/// # Errors
/// `NoProperPolicy` if an episode may never end; `NotConverged`; `Overflow`; `OutOfMemory`; `Stopped` after `stop` was set.
///
/// # Panics
/// If `policy` does not hold a number for each pair.
pub fn expected_visits(mdp: &TabularMdp, policy: &[f64], stop: &StopFlag<'_>) -> Result<Vec<f64>, PlanningError> {
    assert_eq!(policy.len(), mdp.num_states() * mdp.num_actions(), "policy must have a probability for each pair");
    let chain = MarkovChain::new(mdp, 1.0, stop, |state| choices(mdp, policy, state))?;
    let reached = chain.reachable(mdp.initial_distribution(), stop)?;
    let ends = chain.reaching(&filled(&false, mdp.num_states(), stop)?, stop)?;
    if let Some(&state) = reached.iter().find(|&&state| !ends[state]) {
        return Err(PlanningError::NoProperPolicy(state));
    }
    let mut visits = filled(&0.0, mdp.num_states(), stop)?;
    chain.transposed(stop)?.solve(&reached, mdp.initial_distribution(), &mut visits, stop)?;
    Ok(visits)
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
        let staying = TabularMdp::new(1, &[1.0], &[stay(0.0)]).expect("a valid table");
        assert_eq!(policy_evaluation(&staying, &[1.0], 1.0, &stop).expect("no rewards").values, [0.0]);
    }

    #[test]
    fn long_episodes_have_exact_values() {
        let rare = |probability: f64| {
            let outcome = |probability, terminated| Outcome { probability, state: 0, reward: -1.0, terminated };
            TabularMdp::new(1, &[1.0], &[vec![outcome(1.0 - probability, false), outcome(probability, true)]])
        };
        for steps in [1e4, 1e6] {
            let table = rare(1.0 / steps).expect("a valid table");
            let found = policy_evaluation(&table, &[1.0], 1.0, &StopFlag::new()).expect("proper");
            assert!((found.values[0] + steps).abs() <= found.error && found.error < 1e-8 * steps, "{found:?}");
            let visits = expected_visits(&table, &[1.0], &StopFlag::new()).expect("proper");
            assert!((visits[0] - steps).abs() < 1e-8 * steps, "{visits:?}");
        }
    }

    #[test]
    fn large_values_elsewhere_change_nothing() {
        let states = 8;
        let step = |state: usize| {
            let end = state + 1 == states;
            let next = if end { state } else { state + 1 };
            vec![Outcome { probability: 1.0, state: (next as u64).cast_signed(), reward: -1.0, terminated: end }]
        };
        let mut pairs: Vec<_> = (0..states).map(step).collect();
        pairs.push(vec![Outcome { probability: 1.0, state: 0, reward: -1e16, terminated: true }]);
        let mut start = vec![0.0; states + 1];
        start[0] = 1.0;
        let table = TabularMdp::new(1, &start, &pairs).expect("a valid table");
        let found = policy_evaluation(&table, &[1.0; 9], 1.0, &StopFlag::new()).expect("proper");
        assert_eq!(found.values, [-8.0, -7.0, -6.0, -5.0, -4.0, -3.0, -2.0, -1.0, -1e16]);
    }
}
