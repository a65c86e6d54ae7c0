//! The methods on tables whose answers are known, and against each other.

use std::sync::atomic::AtomicBool;

use proptest::prelude::*;

use super::*;
use crate::envs::Env;
use crate::envs::tabular::{Outcome, TabularMdp};

static GO: AtomicBool = AtomicBool::new(false);

fn sure(state: i64, reward: f64, terminated: bool) -> Vec<Outcome> {
    vec![Outcome { probability: 1.0, state, reward, terminated }]
}

fn chance(outcomes: &[(f64, i64, f64, bool)]) -> Vec<Outcome> {
    let outcome = |&(probability, state, reward, terminated)| Outcome { probability, state, reward, terminated };
    outcomes.iter().map(outcome).collect()
}

fn table(actions: usize, rows: &[Vec<Outcome>]) -> TabularMdp {
    let states = rows.len() / actions;
    let mut start = vec![0.0; states];
    start[0] = 1.0;
    TabularMdp::new(actions, &start, rows).expect("a table")
}

/// A corridor of three: left or right, each step costs one, right of the last is the end.
fn corridor() -> TabularMdp {
    let row = |state: i64| [sure((state - 1).max(0), -1.0, false), sure((state + 1).min(2), -1.0, state == 2)];
    table(2, &(0..3).flat_map(row).collect::<Vec<_>>())
}

/// Stand still for nothing, or leave at once for `reward`.
fn door(reward: f64) -> TabularMdp {
    table(2, &[sure(0, 0.0, false), sure(0, reward, true)])
}

#[test]
fn the_corridor_costs_its_length() {
    let solution = value_iteration(&corridor(), 1.0, &GO).expect("it settles");
    assert_eq!(solution.values, [-3.0, -2.0, -1.0]);
    assert_eq!(solution.q_values, [-4.0, -3.0, -4.0, -2.0, -3.0, -1.0]);
    assert_eq!(solution.policy, [1, 1, 1]);
    let same = policy_iteration(&corridor(), 1.0, &GO).expect("it settles");
    assert_eq!((same.values, same.q_values, same.policy), (solution.values, solution.q_values, solution.policy));
}

#[test]
fn a_discount_counts_the_steps_to_a_reward() {
    // 1 after three steps.
    let row = |state: i64| [sure(0, 0.0, false), sure((state + 1).min(2), f64::from(u8::from(state == 2)), state == 2)];
    let table = table(2, &(0..3).flat_map(row).collect::<Vec<_>>());
    for solve in [value_iteration, policy_iteration] {
        let solution = solve(&table, 0.5, &GO).expect("it settles");
        assert_eq!(solution.values, [0.25, 0.5, 1.0]);
        assert_eq!(solution.policy, [1, 1, 1]);
    }
}

#[test]
fn the_best_policy_does_not_put_off_what_is_worth_the_same_later() {
    for solve in [value_iteration, policy_iteration] {
        let solution = solve(&door(1.0), 1.0, &GO).expect("it settles");
        assert_eq!((solution.values, solution.policy), (vec![1.0], vec![1]));
    }
    let horizon = finite_horizon(&door(1.0), 1.0, 5, &GO).expect("it ends");
    assert_eq!(horizon.policy, [1]);
    assert_eq!(horizon.changes, [PolicyChange { steps_to_go: 1, state: 0, action: 1 }]);
    assert_eq!(horizon.sweeps, 2);
}

#[test]
fn not_to_end_may_be_best_but_is_no_policy_that_ends() {
    assert_eq!(value_iteration(&door(-1.0), 1.0, &GO).map(|solution| solution.values), Ok(vec![0.0]));
    assert_eq!(policy_iteration(&door(-1.0), 1.0, &GO).map(|solution| solution.values), Ok(vec![-1.0]));
}

#[test]
fn rewards_without_an_end_are_noticed() {
    let mint = table(2, &[sure(0, 1.0, false), sure(0, 0.0, true)]);
    assert_eq!(value_iteration(&mint, 1.0, &GO), Err(PlanningError::NotConverged));
    assert_eq!(policy_iteration(&mint, 1.0, &GO), Err(PlanningError::UnboundedReturn(0)));
    let trap = table(1, &[sure(0, -1.0, false)]);
    assert_eq!(policy_iteration(&trap, 1.0, &GO), Err(PlanningError::NoProperPolicy(0)));
    let solution = value_iteration(&mint, 0.5, &GO).expect("a discount makes an end");
    assert_eq!(solution.values, [2.0]);
    assert_eq!(finite_horizon(&mint, 1.0, 7, &GO).expect("it ends").expected_return, 7.0);
}

#[test]
fn walls_are_worth_nothing() {
    let walled = table(1, &[sure(0, -1.0, true), sure(1, 0.0, false)]);
    assert_eq!(policy_iteration(&walled, 1.0, &GO).map(|solution| solution.values), Ok(vec![-1.0, 0.0]));
}

#[test]
fn what_is_best_depends_on_the_steps_left() {
    // 1 now, or 3 at the third step.
    let rows = [sure(0, 1.0, true), sure(1, 0.0, false), sure(1, 0.0, true), sure(2, 0.0, false)];
    let table = table(2, &[rows.to_vec(), vec![sure(2, 3.0, true), sure(2, 3.0, true)]].concat());
    for (steps, expected, action) in [(1, 1.0, 0), (2, 1.0, 0), (3, 3.0, 1), (9, 3.0, 1)] {
        let horizon = finite_horizon(&table, 1.0, steps, &GO).expect("it ends");
        assert_eq!((horizon.expected_return, horizon.policy[0]), (expected, action), "{steps} steps");
    }
    let horizon = finite_horizon(&table, 1.0, 9, &GO).expect("it ends");
    let first: Vec<_> = horizon.changes.iter().filter(|change| change.state == 0).collect();
    assert_eq!(
        first,
        [&PolicyChange { steps_to_go: 1, state: 0, action: 0 }, &PolicyChange { steps_to_go: 3, state: 0, action: 1 }]
    );
    assert_eq!(policy_return(&table, &[1, 1, 0], 2, &GO), Ok(0.0));
    assert_eq!(policy_return(&table, &[1, 1, 0], 3, &GO), Ok(3.0));
}

#[test]
fn a_discounted_policy_is_still_judged_without_a_discount() {
    // Impatient: 1 now instead of 3 in two steps, at a discount of 0.5.
    let rows = [sure(0, 1.0, true), sure(1, 0.0, false), sure(1, 3.0, true), sure(1, 3.0, true)];
    let horizon = finite_horizon(&table(2, &rows), 0.25, 2, &GO).expect("it ends");
    assert_eq!((horizon.values[0], horizon.expected_return), (1.0, 1.0));
    let patient = finite_horizon(&table(2, &rows), 0.5, 2, &GO).expect("it ends");
    assert_eq!((patient.values[0], patient.expected_return), (1.5, 3.0));
}

#[test]
fn who_is_told_to_stop_stops() {
    let stop = AtomicBool::new(true);
    let slow = table(1, &[chance(&[(0.999, 0, 1.0, false), (0.001, 0, 1.0, true)])]);
    assert_eq!(value_iteration(&slow, 1.0, &stop), Err(PlanningError::Stopped));
    assert_eq!(policy_iteration(&slow, 1.0, &stop), Err(PlanningError::Stopped));
    assert_eq!(finite_horizon(&slow, 1.0, 100, &stop), Err(PlanningError::Stopped));
    assert_eq!(policy_return(&slow, &[0], 100, &stop), Err(PlanningError::Stopped));
}

fn tables() -> impl Strategy<Value = TabularMdp> {
    let entry = |states: i64| (1_u32..5, 0..states, -3_i32..4, prop::bool::weighted(0.3));
    (1_i64..6, 1_usize..4).prop_flat_map(move |(states, actions)| {
        let row = prop::collection::vec(entry(states), 1..4);
        prop::collection::vec(row, states as usize * actions).prop_map(move |rows| {
            let rows: Vec<Vec<Outcome>> = rows
                .into_iter()
                .map(|entries| {
                    let whole: u32 = entries.iter().map(|entry| entry.0).sum();
                    let outcome = |(weight, state, reward, terminated)| Outcome {
                        probability: f64::from(weight) / f64::from(whole),
                        state,
                        reward: f64::from(reward),
                        terminated,
                    };
                    entries.into_iter().map(outcome).collect()
                })
                .collect();
            let start = vec![1.0 / states as f64; states as usize];
            TabularMdp::new(actions, &start, &rows).expect("a table")
        })
    })
}

/// The best return over all histories: every branch looked at.
fn by_hand(table: &TabularMdp, state: usize, discount: f64, left: u32) -> f64 {
    if left == 0 {
        return 0.0;
    }
    let value = |action| {
        table.outcomes(state, action).fold(0.0, |sum, (probability, step)| {
            let next = if step.terminated { 0.0 } else { by_hand(table, step.state as usize, discount, left - 1) };
            sum + probability * (step.reward + discount * next)
        })
    };
    (0..table.num_actions()).map(value).fold(f64::NEG_INFINITY, f64::max)
}

fn near(left: &[f64], right: &[f64]) -> bool {
    left.iter().zip(right).all(|(left, right)| (left - right).abs() < 1e-8 * (1.0 + right.abs()))
}

proptest! {
    #[test]
    fn a_finite_horizon_is_the_best_of_all_histories(table in tables(), discount in 0.0..=1.0, steps in 0_u32..5) {
        let horizon = finite_horizon(&table, discount, steps.into(), &GO).expect("it ends");
        let expected: Vec<f64> = (0..table.states()).map(|state| by_hand(&table, state, discount, steps)).collect();
        prop_assert_eq!(horizon.values, expected);
    }

    #[test]
    fn both_iterations_find_the_same_values(table in tables(), discount in 0.0..0.99) {
        let values = value_iteration(&table, discount, &GO).expect("it settles");
        let policies = policy_iteration(&table, discount, &GO).expect("it settles");
        prop_assert!(near(&values.values, &policies.values), "{:?} {:?}", values.values, policies.values);
    }

    #[test]
    fn a_long_horizon_comes_to_the_same(table in tables(), discount in 0.0..0.95) {
        let horizon = finite_horizon(&table, discount, 2_000, &GO).expect("it ends");
        let values = value_iteration(&table, discount, &GO).expect("it settles").values;
        prop_assert!(near(&horizon.values, &values), "{:?} {values:?}", horizon.values);
    }

    #[test]
    fn no_policy_returns_more_than_the_best(table in tables(), seed: usize, steps in 0_u64..30) {
        let best = finite_horizon(&table, 1.0, steps, &GO).expect("it ends").expected_return;
        let policy: Vec<usize> = (0..table.states()).map(|state| (seed >> (2 * state)) % table.num_actions()).collect();
        prop_assert!(policy_return(&table, &policy, steps, &GO).expect("it ends") <= best + 1e-12 * best.abs());
    }

    #[test]
    fn without_a_discount_a_policy_that_ends_has_its_values(table in tables()) {
        // Every reward costs: whoever does not end pays for ever, and both methods agree.
        let cost = |(probability, step): (f64, crate::envs::Step<u32>)| Outcome {
            probability,
            state: step.state.into(),
            reward: step.reward - 4.0,
            terminated: step.terminated,
        };
        let rows: Vec<Vec<Outcome>> = (0..table.states() * table.num_actions())
            .map(|row| table.outcomes(row / table.num_actions(), row % table.num_actions()).map(cost).collect())
            .collect();
        let table = TabularMdp::new(table.num_actions(), table.initial(), &rows).expect("a table");
        match policy_iteration(&table, 1.0, &GO) {
            Ok(policies) => {
                let values = value_iteration(&table, 1.0, &GO).expect("it settles");
                prop_assert!(near(&values.values, &policies.values), "{:?} {:?}", values.values, policies.values);
                let long = policy_return(&table, &values.policy, 20_000, &GO).expect("it ends");
                let first: f64 = values.values.iter().sum::<f64>() / table.states() as f64;
                prop_assert!(near(&[long], &[first]), "{long} {first}");
            }
            Err(unsolved) => {
                prop_assert!(matches!(unsolved, PlanningError::NoProperPolicy(_)));
                prop_assert_eq!(value_iteration(&table, 1.0, &GO), Err(PlanningError::NotConverged));
            }
        }
    }
}
