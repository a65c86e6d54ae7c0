//! Policy evaluation: the values of a given policy (Sutton & Barto, section 4.1), and its expected number of visits of
//! each state (section 9.2).

use super::PlanningError;
use super::markov_chain::{Equations, MarkovChain};
use super::problem::{Problem, choices};
use crate::StopFlag;
use crate::envs::Env;
use crate::envs::tabular::TabularMdp;
use crate::memory::{collect, filled};

/// The values of a policy, with bounds on their errors.
#[derive(Clone, Debug, PartialEq)]
pub struct PolicyEvaluation {
    /// The value of each state: the expected discounted return.
    pub values: Vec<f64>,
    /// A bound on the error of each value: the expected (discounted) sum, over the steps to the end, of the residuals
    /// of the Bellman equation and of the rounding errors. It depends only on the states that can follow, so large
    /// values of other states do not matter.
    pub errors: Vec<f64>,
}

/// The solution of v(s) = Σ π(a|s) Σ p (r + γ v(s′)) (equation 4.4), by sweeps in place, or directly if these take
/// long. `policy` holds π(a|s), the actions of state 0 first. Without discounting, states that only lead to each other
/// and collect no reward have the value 0.
///
/// # Errors
/// Without discounting `NoProperPolicy` if, from some state, the policy collects rewards forever; `NotConverged`;
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
    let problem = Problem { mdp, discount, stop };
    let chain = MarkovChain::new(problem, |state| choices(mdp, policy, state))?;
    evaluate(&chain, problem.zeros()?, stop)
}

/// Evaluates the policy of a chain in all states, starting from a guess of their values.
///
/// # Errors
/// As [`policy_evaluation`].
pub(super) fn evaluate(
    chain: &MarkovChain,
    mut values: Vec<f64>,
    stop: &StopFlag<'_>,
) -> Result<PolicyEvaluation, PlanningError> {
    let mut equations = solve(chain, collect(0..chain.num_states())?, &mut values, stop)?;
    let errors = equations.errors(&values, stop)?;
    Ok(PolicyEvaluation { values, errors })
}

/// Replaces an initial guess of the values of some states, which never lead to other states, by the values. Returns the
/// equations of these states.
///
/// Without discounting, states that only lead to each other and collect no reward have the value 0, and no equation.
///
/// # Errors
/// As [`policy_evaluation`].
pub(super) fn solve<'a>(
    chain: &'a MarkovChain,
    mut states: Vec<usize>,
    values: &mut [f64],
    stop: &StopFlag<'_>,
) -> Result<Equations<'a>, PlanningError> {
    if chain.discount == 1.0 {
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
    let mut equations = Equations::new(chain, states);
    equations.solve(&chain.rewards, values, stop)?;
    Ok(equations)
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
    let problem = Problem { mdp, discount: 1.0, stop };
    let chain = MarkovChain::new(problem, |state| choices(mdp, policy, state))?;
    let reached = chain.reachable(mdp.initial_distribution(), stop)?;
    let ends = chain.reaching(&filled(&false, mdp.num_states(), stop)?, stop)?;
    if let Some(&state) = reached.iter().find(|&&state| !ends[state]) {
        return Err(PlanningError::NoProperPolicy(state));
    }
    let mut visits = problem.zeros()?;
    Equations::new(&chain.transposed(stop)?, reached).solve(mdp.initial_distribution(), &mut visits, stop)?;
    Ok(visits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::tabular::Outcome;

    /// A random walk over `states` states, with a reward of 1 at the right end.
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
        assert!(found.errors.iter().all(|&error| error < 1e-13), "{:?}", found.errors);
        for (state, value) in found.values.iter().enumerate() {
            assert!((value - (state + 1) as f64 / 6.0).abs() <= found.errors[state], "{:?}", found.values);
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
        assert!((found.values[0] - 4.0).abs() <= found.errors[0]);
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
            assert!((found.values[0] + steps).abs() <= found.errors[0] && found.errors[0] < 1e-8 * steps, "{found:?}");
            let visits = expected_visits(&table, &[1.0], &StopFlag::new()).expect("proper");
            assert!((visits[0] - steps).abs() < 1e-8 * steps, "{visits:?}");
        }
    }

    #[test]
    fn an_end_that_rounding_hides_is_reported_after_the_sweeps_that_were_made() {
        let outcome = |probability, terminated| Outcome { probability, state: 0, reward: -1.0, terminated };
        let table = TabularMdp::new(1, &[1.0], &[vec![outcome(1.0, false), outcome(1e-17, true)]]);
        let found = policy_evaluation(&table.expect("a valid table"), &[1.0], 1.0, &StopFlag::new());
        assert_eq!(found, Err(PlanningError::NotConverged { sweeps: 1000 }));
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
