//! A finite Markov decision process by its table `P`: Gymnasium's toy text, and grid worlds of one's own.
//!
//! `P[state][action]` lists what may happen as (probability, state, reward, terminated), and every reset and every step
//! makes one draw, where only one thing can happen, too (`gymnasium.envs.toy_text.utils.categorical_sample`).

use std::error::Error;
use std::fmt;

use crate::env::{Env, Step};
use crate::random::Draw;

/// So many comparisons take no longer than a search.
const FEW: usize = 8;
/// Probabilities may miss one by this much.
pub const TOLERANCE: f64 = 1e-9;

/// One entry of `P[state][action]`, as it is written there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// How likely it is.
    pub probability: f64,
    /// Where it leads.
    pub state: i64,
    /// What it brings.
    pub reward: f64,
    /// Whether the episode ends there.
    pub terminated: bool,
}

/// Why a table is none, and where; as Python spells it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BadTable(String);

impl fmt::Display for BadTable {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl Error for BadTable {}

/// `P` and the distribution of the first state, in flat arrays. Its state is the table's.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabular {
    actions: usize,
    initial: Vec<f64>,
    start: Vec<f64>,
    /// Where the outcomes of a state and an action begin; those of the next end them.
    first: Vec<usize>,
    /// For each outcome the largest cumulative sum so far: the first that is above a number is the first sum above it,
    /// and they never fall, which sums of any floats might.
    bounds: Vec<f64>,
    steps: Vec<Step<u32>>,
    /// Of each outcome, as it is written: a step goes by the sums, planning by these.
    probabilities: Vec<f64>,
}

impl Tabular {
    /// `P`'s rows, the actions of state 0 first, each with its outcomes in their order; `start` is
    /// `initial_state_distrib`, a probability for each state.
    ///
    /// # Errors
    /// A probability below 0, probabilities that do not sum to 1, a target outside the table, a reward that is no
    /// number, rows that are no whole states; it says where.
    pub fn new(actions: usize, start: &[f64], rows: &[Vec<Outcome>]) -> Result<Self, BadTable> {
        let bad = |what: String| Err(BadTable(what));
        let states = start.len();
        if actions == 0 || states == 0 || rows.len() != states * actions || u32::try_from(states).is_err() {
            return bad(format!("P must have rows for {states} states of {actions} actions, got {}", rows.len()));
        }
        distribution("initial_state_distrib", start.iter().copied())?;
        let mut table = Self {
            actions,
            initial: start.to_vec(),
            start: cumulative(start),
            first: vec![0],
            bounds: vec![],
            steps: vec![],
            probabilities: vec![],
        };
        for (row, outcomes) in rows.iter().enumerate() {
            let place = format!("P[{}][{}]", row / actions, row % actions);
            distribution(&place, outcomes.iter().map(|outcome| outcome.probability))?;
            for (index, &Outcome { state, reward, terminated, .. }) in outcomes.iter().enumerate() {
                let Some(state) = u32::try_from(state).ok().filter(|&state| (state as usize) < states) else {
                    return bad(format!("{place}[{index}] must lead to a state from 0 to {}, got {state}", states - 1));
                };
                if !reward.is_finite() {
                    return bad(format!("{place}[{index}] must have a finite reward, got {reward}"));
                }
                table.steps.push(Step { state, reward, terminated });
            }
            let probabilities: Vec<f64> = outcomes.iter().map(|outcome| outcome.probability).collect();
            table.bounds.extend(cumulative(&probabilities));
            table.probabilities.extend(probabilities);
            table.first.push(table.steps.len());
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
        let range = self.first[row]..self.first[row + 1];
        self.probabilities[range.clone()].iter().copied().zip(self.steps[range].iter().copied())
    }
}

/// The largest of the sums so far, of one number, two, …, added from left to right as `np.cumsum` does.
fn cumulative(probabilities: &[f64]) -> Vec<f64> {
    let (mut sum, mut largest) = (0.0, f64::NEG_INFINITY);
    let sums = probabilities.iter().map(|probability| {
        sum += probability;
        largest = sum.max(largest);
        largest
    });
    sums.collect()
}

/// Looks whether these are probabilities.
fn distribution(place: &str, probabilities: impl Iterator<Item = f64>) -> Result<(), BadTable> {
    let mut sum = 0.0;
    for (index, probability) in probabilities.enumerate() {
        if !(0.0..=1.0 + TOLERANCE).contains(&probability) {
            return Err(BadTable(format!("{place}[{index}] must have a probability in [0, 1], got {probability}")));
        }
        sum += probability;
    }
    if (sum - 1.0_f64).abs() > TOLERANCE {
        return Err(BadTable(format!("{place} must have probabilities that sum to 1, got {sum}")));
    }
    Ok(())
}

/// `np.argmax(np.cumsum(probabilities) > random)`: index 0 where no sum is above it.
#[inline]
fn chosen(bounds: &[f64], random: f64) -> usize {
    let index = if bounds.len() <= FEW {
        // Counted without a branch, which would often be mispredicted.
        bounds.iter().map(|&bound| usize::from(bound <= random)).sum()
    } else {
        bounds.partition_point(|&bound| bound <= random)
    };
    if index < bounds.len() { index } else { 0 }
}

impl Env for Tabular {
    type State = u32;
    type Action = usize;
    type Observation = u32;

    #[inline]
    fn actions(&self) -> usize {
        self.actions
    }

    #[inline]
    fn reset(&self, draw: &mut impl Draw) -> u32 {
        chosen(&self.start, draw.random()) as u32
    }

    #[inline]
    fn step(&self, state: u32, action: usize, draw: &mut impl Draw) -> Step<u32> {
        assert!(action < self.actions, "action {action} is none of {}", self.actions);
        let row = state as usize * self.actions + action;
        let (from, to) = (self.first[row], self.first[row + 1]);
        self.steps[from + chosen(&self.bounds[from..to], draw.random())]
    }

    #[inline]
    fn observe(&self, &state: &u32) -> u32 {
        state
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A stream of given numbers.
    struct Given<'a>(&'a [f64]);

    impl Draw for Given<'_> {
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

    fn two_states(row: Vec<Outcome>) -> Result<Tabular, BadTable> {
        Tabular::new(1, &[0.5, 0.5], &[row, vec![outcome(1.0, 0)]])
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
    fn a_sure_step_draws_too() {
        let table = two_states(vec![outcome(1.0, 1)]).expect("a table");
        let mut draw = Given(&[0.3]);
        table.step(0, 0, &mut draw);
        assert!(draw.0.is_empty());
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
        let start = Tabular::new(1, &[0.5, f64::NAN], &[vec![outcome(1.0, 1)], vec![outcome(1.0, 0)]]);
        assert!(start.is_err_and(|bad| bad.to_string().starts_with("initial_state_distrib[1] must")));
        assert!(Tabular::new(2, &[1.0], &[vec![outcome(1.0, 0)]]).is_err());
    }

    proptest! {
        #[test]
        fn the_choice_is_categorical_samples(
            probabilities in prop::collection::vec(prop_oneof![0.0..0.3, Just(0.0), -0.2..0.0], 1..12),
            random in 0.0..1.0,
        ) {
            let mut sum = 0.0;
            let sums: Vec<f64> = probabilities.iter().map(|probability| { sum += probability; sum }).collect();
            let expected = sums.iter().position(|&sum| sum > random).unwrap_or(0);
            prop_assert_eq!(chosen(&cumulative(&probabilities), random), expected);
        }
    }
}
