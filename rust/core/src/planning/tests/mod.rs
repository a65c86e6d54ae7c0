//! The methods on tables with known solutions. Random tables are in `random_tables`.

use super::*;
use crate::StopFlag;
use crate::envs::tabular::{Outcome, TabularMdp};

mod random_tables;

static NO_STOP: StopFlag<'static> = StopFlag::new();

fn deterministic(state: i64, reward: f64, terminated: bool) -> Vec<Outcome> {
    vec![Outcome { probability: 1.0, state, reward, terminated }]
}

fn stochastic(outcomes: &[(f64, i64, f64, bool)]) -> Vec<Outcome> {
    let outcome = |&(probability, state, reward, terminated)| Outcome { probability, state, reward, terminated };
    outcomes.iter().map(outcome).collect()
}

/// A table whose episodes begin in state 0.
fn table(num_actions: usize, pairs: &[Vec<Outcome>]) -> TabularMdp {
    let num_states = pairs.len() / num_actions;
    let mut initial_distribution = vec![0.0; num_states];
    initial_distribution[0] = 1.0;
    TabularMdp::new(num_actions, &initial_distribution, pairs).expect("a valid table")
}

/// A corridor of three states: actions left and right, a reward of -1 per step, the end to the right of the last state.
fn corridor() -> TabularMdp {
    let row = |state: i64| {
        [deterministic((state - 1).max(0), -1.0, false), deterministic((state + 1).min(2), -1.0, state == 2)]
    };
    table(2, &(0..3).flat_map(row).collect::<Vec<_>>())
}

/// One state: stay with a reward of 0, or end the episode with `reward`.
fn stay_or_leave(reward: f64) -> TabularMdp {
    table(2, &[deterministic(0, 0.0, false), deterministic(0, reward, true)])
}

#[test]
fn a_corridor_costs_its_length() {
    let solution = value_iteration(&corridor(), 1.0, &NO_STOP).expect("a solution");
    assert_eq!(solution.values, [-3.0, -2.0, -1.0]);
    assert_eq!(solution.q_values, [-4.0, -3.0, -4.0, -2.0, -3.0, -1.0]);
    assert_eq!(solution.policy, [1, 1, 1]);
    let policies = policy_iteration(&corridor(), 1.0, &NO_STOP).expect("a solution");
    assert_eq!(
        (policies.values, policies.q_values, policies.policy),
        (solution.values, solution.q_values, solution.policy)
    );
}

#[test]
fn values_are_discounted_by_the_steps_to_a_reward() {
    // A reward of 1 at the third step to the right.
    let row = |state: i64| {
        [deterministic(0, 0.0, false), deterministic((state + 1).min(2), f64::from(u8::from(state == 2)), state == 2)]
    };
    let table = table(2, &(0..3).flat_map(row).collect::<Vec<_>>());
    for solve in [value_iteration, policy_iteration] {
        let solution = solve(&table, 0.5, &NO_STOP).expect("a solution");
        assert_eq!(solution.values, [0.25, 0.5, 1.0]);
        assert_eq!(solution.policy, [1, 1, 1]);
    }
}

#[test]
fn the_best_policy_does_not_postpone_a_reward() {
    for solve in [value_iteration, policy_iteration] {
        let solution = solve(&stay_or_leave(1.0), 1.0, &NO_STOP).expect("a solution");
        assert_eq!((solution.values, solution.policy), (vec![1.0], vec![1]));
    }
    let horizon = finite_horizon(&stay_or_leave(1.0), 1.0, 5, &NO_STOP).expect("a solution");
    assert_eq!(horizon.policy, [1]);
    assert_eq!(horizon.changes, [PolicyChange { steps_to_go: 1, state: 0, action: 1 }]);
    assert_eq!(horizon.sweeps, 2);
}

#[test]
fn never_ending_may_be_best_but_is_not_proper() {
    assert_eq!(value_iteration(&stay_or_leave(-1.0), 1.0, &NO_STOP).map(|solution| solution.values), Ok(vec![0.0]));
    assert_eq!(policy_iteration(&stay_or_leave(-1.0), 1.0, &NO_STOP).map(|solution| solution.values), Ok(vec![-1.0]));
}

#[test]
fn unbounded_returns_are_errors() {
    let unbounded = table(2, &[deterministic(0, 1.0, false), deterministic(0, 0.0, true)]);
    let no_exit = table(1, &[deterministic(0, -1.0, false)]);
    for solve in [value_iteration, policy_iteration] {
        assert_eq!(solve(&unbounded, 1.0, &NO_STOP), Err(PlanningError::UnboundedReturn(0)));
        assert_eq!(solve(&no_exit, 1.0, &NO_STOP), Err(PlanningError::NoProperPolicy(0)));
    }
    let solution = value_iteration(&unbounded, 0.5, &NO_STOP).expect("a solution");
    assert_eq!(solution.values, [2.0]);
    assert_eq!(finite_horizon(&unbounded, 1.0, 7, &NO_STOP).expect("a solution").expected_return, 7.0);
}

#[test]
fn walls_have_a_value_of_zero() {
    let with_wall = table(1, &[deterministic(0, -1.0, true), deterministic(1, 0.0, false)]);
    assert_eq!(policy_iteration(&with_wall, 1.0, &NO_STOP).map(|solution| solution.values), Ok(vec![-1.0, 0.0]));
}

#[test]
fn states_without_an_end_and_without_rewards_are_worth_nothing() {
    // A reward of 1 on the way to a state that is never left, whose second action costs 1.
    let stays = [deterministic(1, 0.0, false), deterministic(1, -1.0, false)];
    let table = table(2, &[vec![deterministic(1, 1.0, false); 2], stays.to_vec()].concat());
    for solve in [value_iteration, policy_iteration] {
        let solution = solve(&table, 1.0, &NO_STOP).expect("a solution");
        assert_eq!((solution.values, solution.policy), (vec![1.0, 0.0], vec![0, 0]));
    }
}

/// From state 0 to state 1 with a reward of 1 and back with -1; only state 0 has an exit, worth 0.5.
fn there_and_back(first: usize) -> TabularMdp {
    let second = 1 - first;
    let to = |state: usize, reward, terminated| deterministic((state as u64).cast_signed(), reward, terminated);
    let first_rows = [to(second, 1.0, false), to(first, 0.5, true)];
    let second_rows = [to(first, -1.0, false), to(first, -1.0, false)];
    table(2, &if first == 0 { [first_rows, second_rows] } else { [second_rows, first_rows] }.concat())
}

#[test]
fn the_solution_does_not_depend_on_how_states_are_numbered() {
    for first in [0, 1] {
        for solve in [value_iteration, policy_iteration] {
            let solution = solve(&there_and_back(first), 1.0, &NO_STOP).expect("a solution");
            assert_eq!((solution.values[first], solution.values[1 - first]), (0.5, -0.5));
            assert_eq!(solution.policy[first], 1);
        }
    }
}

#[test]
fn returns_beyond_the_range_of_numbers_are_errors() {
    let huge = table(1, &[deterministic(1, 1e308, false), deterministic(1, 1e308, true)]);
    let overflow = PlanningError::Overflow(0);
    for solve in [value_iteration, policy_iteration] {
        assert_eq!(solve(&huge, 1.0, &NO_STOP), Err(overflow));
    }
    assert_eq!(policy_evaluation(&huge, &[1.0; 2], 1.0, &NO_STOP), Err(overflow));
    assert_eq!(finite_horizon(&huge, 1.0, 2, &NO_STOP), Err(overflow));
    assert_eq!(policy_return(&huge, &[0; 2], 2, &NO_STOP), Err(overflow));
    assert_eq!(sweep(&huge, None, 1.0, &mut [0.0, 1e308], true, &NO_STOP), Err(overflow));
    assert_eq!(policy_return(&huge, &[0; 2], 1, &NO_STOP), Ok(1e308));
}

#[test]
fn rounding_does_not_postpone() {
    // The same rewards in another order: 0.1 + (0.2 + 0.3) is smaller than 0.3 + (0.2 + 0.1) by one bit.
    let rows = [
        [deterministic(1, 0.1, false), deterministic(3, 0.3, false)],
        [deterministic(2, 0.2, false), deterministic(2, 0.2, false)],
        [deterministic(2, 0.3, true), deterministic(2, 0.3, true)],
        [deterministic(4, 0.0, false), deterministic(4, 0.0, false)],
        [deterministic(5, 0.2, false), deterministic(5, 0.2, false)],
        [deterministic(5, 0.1, true), deterministic(5, 0.1, true)],
    ];
    let horizon = finite_horizon(&table(2, &rows.concat()), 1.0, 4, &NO_STOP).expect("a solution");
    // With three steps to go, the second way is too long; with four, it is as good.
    assert_eq!(horizon.policy[0], 0);
    assert_eq!(horizon.changes.iter().filter(|change| change.state == 0).count(), 2);
}

#[test]
fn the_best_action_depends_on_the_steps_to_go() {
    // A reward of 1 now, or 3 at the third step.
    let rows = [
        deterministic(0, 1.0, true),
        deterministic(1, 0.0, false),
        deterministic(1, 0.0, true),
        deterministic(2, 0.0, false),
    ];
    let table = table(2, &[rows.to_vec(), vec![deterministic(2, 3.0, true), deterministic(2, 3.0, true)]].concat());
    for (steps, expected, action) in [(1, 1.0, 0), (2, 1.0, 0), (3, 3.0, 1), (9, 3.0, 1)] {
        let horizon = finite_horizon(&table, 1.0, steps, &NO_STOP).expect("a solution");
        assert_eq!((horizon.expected_return, horizon.policy[0]), (expected, action), "{steps} steps");
    }
    let horizon = finite_horizon(&table, 1.0, 9, &NO_STOP).expect("a solution");
    let first: Vec<_> = horizon.changes.iter().filter(|change| change.state == 0).collect();
    assert_eq!(
        first,
        [&PolicyChange { steps_to_go: 1, state: 0, action: 0 }, &PolicyChange { steps_to_go: 3, state: 0, action: 1 }]
    );
    assert_eq!(policy_return(&table, &[1, 1, 0], 2, &NO_STOP), Ok(0.0));
    assert_eq!(policy_return(&table, &[1, 1, 0], 3, &NO_STOP), Ok(3.0));
}

#[test]
fn the_expected_return_is_undiscounted() {
    // A reward of 1 now is better than 3 in the next step with a discount of 0.25, and worse with 0.5.
    let rows = [
        deterministic(0, 1.0, true),
        deterministic(1, 0.0, false),
        deterministic(1, 3.0, true),
        deterministic(1, 3.0, true),
    ];
    let horizon = finite_horizon(&table(2, &rows), 0.25, 2, &NO_STOP).expect("a solution");
    assert_eq!((horizon.values[0], horizon.expected_return), (1.0, 1.0));
    let patient = finite_horizon(&table(2, &rows), 0.5, 2, &NO_STOP).expect("a solution");
    assert_eq!((patient.values[0], patient.expected_return), (1.5, 3.0));
}

#[test]
fn the_stop_flag_stops_every_method() {
    let stop = StopFlag::new();
    stop.set();
    let slow = table(1, &[stochastic(&[(0.999, 0, 1.0, false), (0.001, 0, 1.0, true)])]);
    assert_eq!(value_iteration(&slow, 1.0, &stop), Err(PlanningError::Stopped));
    assert_eq!(policy_iteration(&slow, 1.0, &stop), Err(PlanningError::Stopped));
    assert_eq!(finite_horizon(&slow, 1.0, 100, &stop), Err(PlanningError::Stopped));
    assert_eq!(policy_return(&slow, &[0], 100, &stop), Err(PlanningError::Stopped));
}

#[test]
fn a_policy_may_depend_on_the_steps_taken() {
    // Left first, then right for the remaining steps.
    let policy = [vec![0; 3], vec![1; 9]].concat();
    assert_eq!(policy_return(&corridor(), &policy, 4, &NO_STOP), Ok(-4.0));
    let repeated = vec![1; 12];
    assert_eq!(policy_return(&corridor(), &repeated, 4, &NO_STOP), policy_return(&corridor(), &[1; 3], 4, &NO_STOP));
}

#[test]
fn a_stationary_policy_is_proven_where_its_rewards_cancel() {
    // Two ways whose first three rewards sum to 0, up to rounding: 0.1 + 0.2 - 0.3, and then 1; or 0.3 + 0.1 - 0.4.
    let both = |state, reward, terminated| vec![deterministic(state, reward, terminated); 2];
    let rows = [
        vec![deterministic(1, 0.1, false), deterministic(4, 0.3, false)],
        both(2, 0.2, false),
        both(3, -0.3, false),
        both(3, 1.0, true),
        both(5, 0.1, false),
        both(5, -0.4, true),
    ];
    let mdp = Mdp::from(table(2, &rows.concat()));
    let optimal = finite_horizon(&mdp.table, 1.0, 3, &NO_STOP).expect("a solution").expected_return;
    let found = stationary_policy(&mdp, 6, 3, &NO_STOP).expect("a solution").expect("a small table");
    assert!(found.proven && found.expected_return != optimal, "{} {optimal}", found.expected_return);
}
