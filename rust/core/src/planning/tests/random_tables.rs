//! The methods on random tables, compared with each other and with a search over all histories.

use proptest::prelude::*;

use super::*;
use crate::envs::{Env, Step};

/// Random transition tables.
fn mdps() -> impl Strategy<Value = TabularMdp> {
    let entry = |states: i64| (1_u32..5, 0..states, -3_i32..4, prop::bool::weighted(0.3));
    (1_i64..6, 1_usize..4).prop_flat_map(move |(states, actions)| {
        let row = prop::collection::vec(entry(states), 1..4);
        prop::collection::vec(row, states as usize * actions).prop_map(move |rows| {
            let rows: Vec<Vec<Outcome>> = rows
                .into_iter()
                .map(|entries| {
                    let total: u32 = entries.iter().map(|entry| entry.0).sum();
                    let outcome = |(weight, state, reward, terminated)| Outcome {
                        probability: f64::from(weight) / f64::from(total),
                        state,
                        reward: f64::from(reward),
                        terminated,
                    };
                    entries.into_iter().map(outcome).collect()
                })
                .collect();
            let initial_distribution = vec![1.0 / states as f64; states as usize];
            TabularMdp::new(actions, &initial_distribution, &rows).expect("a valid table")
        })
    })
}

/// The best return over all histories, by trying every branch.
fn best_return(mdp: &TabularMdp, state: usize, discount: f64, steps_to_go: u32) -> f64 {
    if steps_to_go == 0 {
        return 0.0;
    }
    let value = |action| {
        mdp.outcomes(state, action).fold(0.0, |sum, (probability, step)| {
            let next =
                if step.terminated { 0.0 } else { best_return(mdp, step.state as usize, discount, steps_to_go - 1) };
            sum + probability * (step.reward + discount * next)
        })
    };
    (0..mdp.num_actions()).map(value).fold(f64::NEG_INFINITY, f64::max)
}

fn close(left: &[f64], right: &[f64]) -> bool {
    left.iter().zip(right).all(|(left, right)| (left - right).abs() < 1e-8 * (1.0 + right.abs()))
}

proptest! {
    #[test]
    fn a_finite_horizon_is_the_best_of_all_histories(mdp in mdps(), discount in 0.0..=1.0, steps in 0_u32..5) {
        let horizon = finite_horizon(&mdp, discount, steps.into(), &NO_STOP).expect("a solution");
        let expected: Vec<f64> = (0..mdp.num_states()).map(|state| best_return(&mdp, state, discount, steps)).collect();
        prop_assert_eq!(horizon.values, expected);
    }

    #[test]
    fn both_iterations_find_the_same_values(mdp in mdps(), discount in 0.0..0.99) {
        let values = value_iteration(&mdp, discount, &NO_STOP).expect("a solution");
        let policies = policy_iteration(&mdp, discount, &NO_STOP).expect("a solution");
        prop_assert!(close(&values.values, &policies.values), "{:?} {:?}", values.values, policies.values);
    }

    #[test]
    fn a_long_horizon_has_the_values_without_a_time_limit(mdp in mdps(), discount in 0.0..0.95) {
        let horizon = finite_horizon(&mdp, discount, 2_000, &NO_STOP).expect("a solution");
        let values = value_iteration(&mdp, discount, &NO_STOP).expect("a solution").values;
        prop_assert!(close(&horizon.values, &values), "{:?} {values:?}", horizon.values);
    }

    #[test]
    fn no_policy_returns_more_than_the_best(mdp in mdps(), seed: usize, steps in 0_u64..30) {
        let best = finite_horizon(&mdp, 1.0, steps, &NO_STOP).expect("a solution").expected_return;
        let policy: Vec<usize> = (0..mdp.num_states()).map(|state| (seed >> (2 * state)) % mdp.num_actions()).collect();
        prop_assert!(policy_return(&mdp, &policy, steps, &NO_STOP).expect("a solution") <= best + 1e-12 * best.abs());
    }

    #[test]
    fn without_discounting_both_iterations_agree_on_costs(mdp in mdps()) {
        // Every reward is negative, so never ending costs without bound.
        let cost = |(probability, step): (f64, Step<u32>)| Outcome {
            probability,
            state: step.state.into(),
            reward: step.reward - 4.0,
            terminated: step.terminated,
        };
        let rows: Vec<Vec<Outcome>> = (0..mdp.num_states() * mdp.num_actions())
            .map(|row| mdp.outcomes(row / mdp.num_actions(), row % mdp.num_actions()).map(cost).collect())
            .collect();
        let mdp = TabularMdp::new(mdp.num_actions(), mdp.initial_distribution(), &rows).expect("a valid table");
        match policy_iteration(&mdp, 1.0, &NO_STOP) {
            Ok(policies) => {
                let values = value_iteration(&mdp, 1.0, &NO_STOP).expect("a solution");
                prop_assert!(close(&values.values, &policies.values), "{:?} {:?}", values.values, policies.values);
                let long = policy_return(&mdp, &values.policy, 20_000, &NO_STOP).expect("a solution");
                let first: f64 = values.values.iter().sum::<f64>() / mdp.num_states() as f64;
                prop_assert!(close(&[long], &[first]), "{long} {first}");
            }
            Err(error) => {
                prop_assert!(matches!(error, PlanningError::NoProperPolicy(_)));
                prop_assert_eq!(value_iteration(&mdp, 1.0, &NO_STOP), Err(error));
            }
        }
    }
}
