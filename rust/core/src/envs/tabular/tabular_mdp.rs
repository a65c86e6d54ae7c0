//! A finite Markov decision process by its table `P`: Gymnasium's toy text, and grid worlds of one's own.
//!
//! `P[state][action]` lists what may happen as (probability, state, reward, terminated), and every reset and every step
//! makes one draw, where only one thing can happen, too (`gymnasium.envs.toy_text.utils.categorical_sample`).

use super::InvalidMdp;
use super::Outcome;
use super::outcome::distribution;
use super::outcome_distribution::{OutcomeDistribution, bounds, rank};
use crate::envs::{Env, Step, TransitionProbability};
use crate::random::Rng;

/// `P` and the distribution of the first state, in flat arrays. Its state is the table's.
#[derive(Clone, Debug, PartialEq)]
pub struct TabularMdp {
    actions: usize,
    initial: Vec<f64>,
    start: Vec<u64>,
    /// What a state and an action may lead to; empty where nothing is left to chance, and each has the step of its number.
    rows: Vec<OutcomeDistribution>,
    /// Of each outcome the least draw that passes it by.
    bounds: Vec<u64>,
    steps: Vec<Step<u32>>,
    /// Of each outcome, as it is written: steps go by the bounds, plans by these.
    probabilities: Vec<f64>,
}

impl TabularMdp {
    /// `P`'s rows, the actions of state 0 first, each with its outcomes in their order; `start` is
    /// `initial_state_distrib`, a probability for each state.
    ///
    /// # Errors
    /// A probability below 0, probabilities that do not sum to 1, a target outside the table, a reward that is no
    /// number, rows that are no whole states; it says where.
    pub fn new(actions: usize, start: &[f64], rows: &[Vec<Outcome>]) -> Result<Self, InvalidMdp> {
        let bad = |what: String| Err(InvalidMdp(what));
        let (states, outcomes) = (start.len(), rows.iter().map(Vec::len).sum::<usize>());
        if actions == 0 || states == 0 || rows.len() != states * actions || u32::try_from(states).is_err() {
            return bad(format!("P must have rows for {states} states of {actions} actions, got {}", rows.len()));
        }
        if u32::try_from(outcomes).is_err() {
            return bad(format!("P must have at most {} outcomes, got {outcomes}", u32::MAX));
        }
        distribution(|| "initial_state_distrib".into(), start.iter().copied())?;
        let deterministic = rows.iter().all(|outcomes| outcomes.len() == 1);
        let mut table = Self {
            actions,
            initial: start.to_vec(),
            start: bounds(start),
            rows: vec![],
            bounds: vec![],
            steps: vec![],
            probabilities: vec![],
        };
        for (row, outcomes) in rows.iter().enumerate() {
            let place = || format!("P[{}][{}]", row / actions, row % actions);
            distribution(place, outcomes.iter().map(|outcome| outcome.probability))?;
            let first = table.steps.len();
            table.probabilities.extend(outcomes.iter().map(|outcome| outcome.probability));
            if !deterministic {
                let bounds = bounds(&table.probabilities[first..]);
                table.rows.push(OutcomeDistribution::new(&bounds, first));
                table.bounds.extend(bounds);
            }
            for (index, &Outcome { state, reward, terminated, .. }) in outcomes.iter().enumerate() {
                let Some(state) = u32::try_from(state).ok().filter(|&state| (state as usize) < states) else {
                    let last = states - 1;
                    return bad(format!("{}[{index}] must lead to a state from 0 to {last}, got {state}", place()));
                };
                if !reward.is_finite() {
                    return bad(format!("{}[{index}] must have a finite reward, got {reward}", place()));
                }
                table.steps.push(Step { state, reward, terminated });
            }
        }
        Ok(table)
    }

    /// How many states there are.
    pub fn states(&self) -> usize {
        self.start.len()
    }

    /// How likely each first state is.
    pub fn initial(&self) -> &[f64] {
        &self.initial
    }

    /// What may happen, in the order of `P`: how likely it is, and the step.
    ///
    /// # Panics
    /// For a state or an action outside the table.
    #[inline]
    pub fn outcomes(&self, state: usize, action: usize) -> impl Iterator<Item = (f64, Step<u32>)> + '_ {
        assert!(action < self.actions, "action {action} is none of {}", self.actions);
        let row = state * self.actions + action;
        let range = if self.rows.is_empty() { row..row + 1 } else { self.rows[row].range() };
        self.probabilities[range.clone()].iter().copied().zip(self.steps[range].iter().copied())
    }

    /// Draws what happens: the number of the outcome.
    #[expect(clippy::inline_always, reason = "a call a step costs a fifth of it")]
    #[inline(always)]
    fn outcome(&self, state: u32, action: usize, rng: &mut impl Rng) -> usize {
        assert!(action < self.actions, "action {action} is none of {}", self.actions);
        let (row, u53) = (state as usize * self.actions + action, rng.random_u53());
        if self.rows.is_empty() {
            return row;
        }
        self.rows[row].sample(&self.bounds, u53)
    }
}

impl Env for TabularMdp {
    type State = u32;
    type Action = usize;
    type Observation = u32;

    #[inline]
    fn num_actions(&self) -> usize {
        self.actions
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> u32 {
        let state = rank(&self.start, rng.random_u53());
        if state < self.start.len() { state as u32 } else { 0 }
    }

    #[expect(clippy::inline_always, reason = "a call a step costs a fifth of it")]
    #[inline(always)]
    fn step(&self, state: u32, action: usize, rng: &mut impl Rng) -> Step<u32> {
        self.steps[self.outcome(state, action, rng)]
    }

    #[inline]
    fn observe(&self, &state: &u32) -> u32 {
        state
    }
}

impl TransitionProbability for TabularMdp {
    #[inline]
    fn step_with_probability(&self, state: u32, action: usize, rng: &mut impl Rng) -> (Step<u32>, f64) {
        let outcome = self.outcome(state, action, rng);
        (self.steps[outcome], self.probabilities[outcome])
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::random::{Rng, TWO_POW_53};

    /// A stream of given numbers.
    struct Given<'a>(&'a [f64]);

    impl Rng for Given<'_> {
        fn random(&mut self) -> f64 {
            let (&first, rest) = self.0.split_first().expect("one draw at a time");
            self.0 = rest;
            first
        }
        fn integers(&mut self, _below: u32) -> u32 {
            unreachable!("a table draws no integers")
        }
    }

    fn outcome(probability: f64, state: i64) -> Outcome {
        Outcome { probability, state, reward: probability, terminated: state == 0 }
    }

    fn two_states(row: Vec<Outcome>) -> Result<TabularMdp, InvalidMdp> {
        TabularMdp::new(1, &[0.5, 0.5], &[row, vec![outcome(1.0, 0)]])
    }

    fn fault(row: Vec<Outcome>) -> String {
        two_states(row).expect_err("a bad table").to_string()
    }

    #[test]
    fn the_first_sum_above_the_draw_wins_and_duplicates_stay_apart() {
        let table = two_states(vec![outcome(0.25, 1), outcome(0.25, 1), outcome(0.5, 0)]).expect("a table");
        for (random, reward, state) in [(0.0, 0.25, 1), (0.25, 0.25, 1), (0.499, 0.25, 1), (0.5, 0.5, 0)] {
            let step = table.step(0, 0, &mut Given(&[random]));
            assert_eq!(step, Step { state, reward, terminated: state == 0 });
        }
        assert_eq!(table.reset(&mut Given(&[0.49])), 0);
        assert_eq!(table.reset(&mut Given(&[0.5])), 1);
    }

    #[test]
    fn it_tells_what_it_was_made_of() {
        let uneven = vec![outcome(0.25, 1), outcome(0.75, 0)];
        for row in [uneven, vec![outcome(1.0, 1)]] {
            let table = two_states(row.clone()).expect("a table");
            let steps = |row: &[Outcome]| -> Vec<_> {
                let step =
                    |&Outcome { reward, state, terminated, .. }| Step { state: state as u32, reward, terminated };
                row.iter().map(|outcome| (outcome.probability, step(outcome))).collect()
            };
            assert_eq!(table.outcomes(0, 0).collect::<Vec<_>>(), steps(&row));
            assert_eq!(table.outcomes(1, 0).collect::<Vec<_>>(), steps(&[outcome(1.0, 0)]));
            assert_eq!(table.initial(), [0.5, 0.5]);
        }
    }

    #[test]
    fn a_sure_step_draws_too() {
        let table = two_states(vec![outcome(1.0, 1)]).expect("a table");
        let mut rng = Given(&[0.3]);
        table.step(0, 0, &mut rng);
        assert!(rng.0.is_empty());
    }

    #[test]
    fn a_draw_above_all_sums_takes_the_first_outcome() {
        let table = two_states(vec![outcome(0.5, 1), outcome(0.5 - 1e-10, 0)]).expect("sums within the tolerance pass");
        assert_eq!(table.step(0, 0, &mut Given(&[1.0 - 1e-11])).state, 1);
    }

    #[test]
    fn a_bad_table_says_where() {
        assert_eq!(fault(vec![outcome(0.9, 1)]), "P[0][0] must have probabilities that sum to 1, got 0.9");
        assert_eq!(fault(vec![]), "P[0][0] must have probabilities that sum to 1, got 0");
        assert_eq!(fault(vec![outcome(1.0, 2)]), "P[0][0][0] must lead to a state from 0 to 1, got 2");
        assert_eq!(fault(vec![outcome(1.0, -1)]), "P[0][0][0] must lead to a state from 0 to 1, got -1");
        let lost = [outcome(1.5, 0), outcome(-0.5, 1)];
        assert_eq!(fault(lost.into()), "P[0][0][0] must have a probability in [0, 1], got 1.5");
        let endless = Outcome { reward: f64::INFINITY, ..outcome(1.0, 1) };
        assert_eq!(fault(vec![endless]), "P[0][0][0] must have a finite reward, got inf");
        let start = TabularMdp::new(1, &[0.5, f64::NAN], &[vec![outcome(1.0, 1)], vec![outcome(1.0, 0)]]);
        assert!(start.is_err_and(|bad| bad.to_string().starts_with("initial_state_distrib[1] must")));
        assert!(TabularMdp::new(2, &[1.0], &[vec![outcome(1.0, 0)]]).is_err());
    }

    proptest! {
        #[test]
        fn the_choice_is_categorical_samples(
            weights in prop::collection::vec(prop_oneof![0.0..1.0, Just(0.0)], 1..12),
            short in prop_oneof![Just(0.0), 0.0..1e-10],
            place in 0.0..1.0,
            at_a_sum in any::<prop::sample::Index>(),
        ) {
            let total: f64 = weights.iter().sum();
            prop_assume!(total > 0.0);
            let probabilities: Vec<f64> = weights.iter().map(|weight| weight / total * (1.0 - short)).collect();
            let mut sum = 0.0;
            let sums: Vec<f64> = probabilities.iter().map(|probability| { sum += probability; sum }).collect();
            let outcomes = (0..).zip(&probabilities).map(|(state, &probability)| outcome(probability, state)).collect();
            let rest = vec![vec![outcome(1.0, 0)]; weights.len() - 1];
            let table = TabularMdp::new(1, &probabilities, &[vec![outcomes], rest].concat()).expect("a table");
            let sum = at_a_sum.get(&sums);
            // Draws lie on a grid; those around a sum matter most.
            for random in [place, *sum, sum - 2.0 / TWO_POW_53, 1.0 - 1.0 / TWO_POW_53] {
                let random = ((random * TWO_POW_53).round() / TWO_POW_53).clamp(0.0, 1.0 - 1.0 / TWO_POW_53);
                let expected = sums.iter().position(|&sum| sum > random).unwrap_or(0) as u32;
                prop_assert_eq!(table.step(0, 0, &mut Given(&[random])).state, expected);
                prop_assert_eq!(table.reset(&mut Given(&[random])), expected);
            }
        }
    }
}
