//! Finite Markov decision processes given by a transition table, such as Gymnasium's toy text environments.

use std::sync::Arc;

use super::initial_states::InitialStates;
use super::interval_steps::IntervalSteps;
use super::outcome::check_distribution;
use super::outcome_distribution::{OutcomeDistribution, thresholds};
use super::{InvalidMdp, Outcome};
use crate::envs::{Env, Step, TransitionProbability};
use crate::random::Rng;

/// A Markov decision process with Gymnasium's transition table `P`: `P[state][action]` lists the possible outcomes
/// (probability, next state, reward, terminated). Each reset and each step, even a deterministic one, draws exactly one
/// `random()`, as in Gymnasium.
///
/// A clone shares the table, so many runs need only one copy.
#[derive(Clone, Debug, PartialEq)]
pub struct TabularMdp {
    num_actions: usize,
    initial_states: InitialStates,
    /// The distribution of each state-action pair. Empty if every pair has a single outcome; the index of the outcome
    /// is then that of the pair.
    distributions: Arc<[OutcomeDistribution]>,
    /// The threshold, step and probability of each outcome. Steps use the thresholds, planning the probabilities.
    thresholds: Arc<[u64]>,
    steps: Arc<[Step<u32>]>,
    probabilities: Arc<[f64]>,
    /// The steps by interval, if there are several outcomes per pair but few different thresholds.
    interval_steps: Option<IntervalSteps>,
}

impl TabularMdp {
    /// `initial_distribution` is `initial_state_distrib`, a probability for each state. `pairs` holds
    /// `P[state][action]` for each state-action pair, the actions of state 0 first.
    ///
    /// # Errors
    /// A probability outside [0, 1], probabilities that do not sum to 1, a next state outside the table, a reward that
    /// is not finite, or a number of pairs other than `num_actions` per state. The error names the location.
    pub fn new(num_actions: usize, initial_distribution: &[f64], pairs: &[Vec<Outcome>]) -> Result<Self, InvalidMdp> {
        let invalid = |message: String| Err(InvalidMdp(message));
        let (num_states, num_outcomes) = (initial_distribution.len(), pairs.iter().map(Vec::len).sum::<usize>());
        if num_actions == 0
            || num_states == 0
            || pairs.len() != num_states * num_actions
            || u32::try_from(num_states).is_err()
        {
            let got = pairs.len();
            return invalid(format!("P must have rows for {num_states} states of {num_actions} actions, got {got}"));
        }
        if u32::try_from(num_outcomes).is_err() {
            return invalid(format!("P must have at most {} outcomes, got {num_outcomes}", u32::MAX));
        }
        check_distribution(|| "initial_state_distrib".into(), initial_distribution.iter().copied())?;
        let deterministic = pairs.iter().all(|outcomes| outcomes.len() == 1);
        let (mut distributions, mut all_thresholds) = (Vec::new(), Vec::new());
        let (mut steps, mut probabilities) = (Vec::with_capacity(num_outcomes), Vec::with_capacity(num_outcomes));
        for (pair, outcomes) in pairs.iter().enumerate() {
            let location = || format!("P[{}][{}]", pair / num_actions, pair % num_actions);
            check_distribution(location, outcomes.iter().map(|outcome| outcome.probability))?;
            let first = steps.len();
            probabilities.extend(outcomes.iter().map(|outcome| outcome.probability));
            if !deterministic {
                let thresholds = thresholds(&probabilities[first..]);
                distributions.push(OutcomeDistribution::new(&thresholds, first));
                all_thresholds.extend(thresholds);
            }
            for (index, &Outcome { state, reward, terminated, .. }) in outcomes.iter().enumerate() {
                let Some(state) = u32::try_from(state).ok().filter(|&state| (state as usize) < num_states) else {
                    let last = num_states - 1;
                    return invalid(format!(
                        "{}[{index}] must lead to a state from 0 to {last}, got {state}",
                        location()
                    ));
                };
                if !reward.is_finite() {
                    return invalid(format!("{}[{index}] must have a finite reward, got {reward}", location()));
                }
                steps.push(Step { state, reward, terminated });
            }
        }
        let sample = |pair: usize, u53| steps[OutcomeDistribution::sample(&distributions[pair], &all_thresholds, u53)];
        let interval_steps =
            if deterministic { None } else { IntervalSteps::new(pairs.len(), &all_thresholds, sample) };
        Ok(Self {
            num_actions,
            initial_states: InitialStates::new(initial_distribution),
            interval_steps,
            distributions: distributions.into(),
            thresholds: all_thresholds.into(),
            steps: steps.into(),
            probabilities: probabilities.into(),
        })
    }

    /// The number of states.
    pub fn num_states(&self) -> usize {
        self.initial_distribution().len()
    }

    /// The number of outcomes of all state-action pairs.
    pub fn num_outcomes(&self) -> usize {
        self.steps.len()
    }

    /// The probability of each initial state.
    pub fn initial_distribution(&self) -> &[f64] {
        self.initial_states.probabilities()
    }

    /// The outcomes of a state-action pair in the order of `P`: their probabilities and steps.
    ///
    /// # Panics
    /// If the state or the action is out of range.
    #[inline]
    pub fn outcomes(&self, state: usize, action: usize) -> impl Iterator<Item = (f64, Step<u32>)> + '_ {
        let pair = self.pair(state, action);
        let range = if self.is_deterministic() { pair..pair + 1 } else { self.distributions[pair].range() };
        self.probabilities[range.clone()].iter().copied().zip(self.steps[range].iter().copied())
    }

    /// Whether every state-action pair has a single outcome.
    #[inline]
    fn is_deterministic(&self) -> bool {
        self.distributions.is_empty()
    }

    /// The index of a state-action pair.
    #[inline]
    fn pair(&self, state: usize, action: usize) -> usize {
        assert!(action < self.num_actions, "action must be less than {}, got {action}", self.num_actions);
        state * self.num_actions + action
    }

    /// The index of the outcome of a state-action pair that a draw of 53 bits selects.
    #[expect(clippy::inline_always, reason = "a call per step would take a fifth of its time")]
    #[inline(always)]
    fn sample_outcome(&self, pair: usize, u53: u64) -> usize {
        if self.is_deterministic() { pair } else { self.distributions[pair].sample(&self.thresholds, u53) }
    }
}

impl Env for TabularMdp {
    type State = u32;
    type Action = usize;
    type Observation = u32;

    #[inline]
    fn num_actions(&self) -> usize {
        self.num_actions
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> u32 {
        self.initial_states.sample(rng.random_u53())
    }

    #[expect(clippy::inline_always, reason = "a call per step would take a fifth of its time")]
    #[inline(always)]
    fn step(&self, state: u32, action: usize, rng: &mut impl Rng) -> Step<u32> {
        let (pair, u53) = (self.pair(state as usize, action), rng.random_u53());
        match &self.interval_steps {
            _ if self.is_deterministic() => self.steps[pair],
            Some(interval_steps) => interval_steps.step(pair, u53),
            None => self.steps[self.sample_outcome(pair, u53)],
        }
    }

    #[inline]
    fn observe(&self, &state: &u32) -> u32 {
        state
    }
}

impl TransitionProbability for TabularMdp {
    #[inline]
    fn step_with_probability(&self, state: u32, action: usize, rng: &mut impl Rng) -> (Step<u32>, f64) {
        let index = self.sample_outcome(self.pair(state as usize, action), rng.random_u53());
        (self.steps[index], self.probabilities[index])
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::envs::tabular::test_support::probabilities;
    use crate::random::{Rng, TWO_POW_53};

    /// A generator that returns given numbers.
    struct Given<'a>(&'a [f64]);

    impl Rng for Given<'_> {
        fn random(&mut self) -> f64 {
            let (&first, rest) = self.0.split_first().expect("a number is left");
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

    /// Two states with one action: state 0 with these outcomes, state 1 terminal.
    fn two_states(row: Vec<Outcome>) -> Result<TabularMdp, InvalidMdp> {
        TabularMdp::new(1, &[0.5, 0.5], &[row, vec![outcome(1.0, 0)]])
    }

    fn error(row: Vec<Outcome>) -> String {
        two_states(row).expect_err("an invalid table").to_string()
    }

    #[test]
    fn the_first_cumulative_sum_above_the_draw_wins_and_duplicates_are_not_merged() {
        let table = two_states(vec![outcome(0.25, 1), outcome(0.25, 1), outcome(0.5, 0)]).expect("a valid table");
        for (random, reward, state) in [(0.0, 0.25, 1), (0.25, 0.25, 1), (0.499, 0.25, 1), (0.5, 0.5, 0)] {
            let step = table.step(0, 0, &mut Given(&[random]));
            assert_eq!(step, Step { state, reward, terminated: state == 0 });
        }
        assert_eq!(table.reset(&mut Given(&[0.49])), 0);
        assert_eq!(table.reset(&mut Given(&[0.5])), 1);
    }

    #[test]
    fn outcomes_are_those_given() {
        let stochastic = vec![outcome(0.25, 1), outcome(0.75, 0)];
        for row in [stochastic, vec![outcome(1.0, 1)]] {
            let table = two_states(row.clone()).expect("a valid table");
            let steps = |row: &[Outcome]| -> Vec<_> {
                let step =
                    |&Outcome { reward, state, terminated, .. }| Step { state: state as u32, reward, terminated };
                row.iter().map(|outcome| (outcome.probability, step(outcome))).collect()
            };
            assert_eq!(table.outcomes(0, 0).collect::<Vec<_>>(), steps(&row));
            assert_eq!(table.outcomes(1, 0).collect::<Vec<_>>(), steps(&[outcome(1.0, 0)]));
            assert_eq!(table.initial_distribution(), [0.5, 0.5]);
        }
    }

    #[test]
    fn a_deterministic_step_draws_too() {
        let table = two_states(vec![outcome(1.0, 1)]).expect("a valid table");
        let mut rng = Given(&[0.3]);
        table.step(0, 0, &mut rng);
        assert!(rng.0.is_empty());
    }

    #[test]
    fn a_draw_above_all_sums_selects_the_first_outcome() {
        let table = two_states(vec![outcome(0.5, 1), outcome(0.5 - 1e-10, 0)]).expect("sums within the tolerance pass");
        assert_eq!(table.step(0, 0, &mut Given(&[1.0 - 1e-11])).state, 1);
    }

    #[test]
    fn an_invalid_table_is_refused_by_location() {
        assert_eq!(error(vec![outcome(0.9, 1)]), "P[0][0] must have probabilities that sum to 1, got 0.9");
        assert_eq!(error(vec![]), "P[0][0] must have probabilities that sum to 1, got 0");
        assert_eq!(error(vec![outcome(1.0, 2)]), "P[0][0][0] must lead to a state from 0 to 1, got 2");
        assert_eq!(error(vec![outcome(1.0, -1)]), "P[0][0][0] must lead to a state from 0 to 1, got -1");
        let out_of_range = [outcome(1.5, 0), outcome(-0.5, 1)];
        assert_eq!(error(out_of_range.into()), "P[0][0][0] must have a probability in [0, 1], got 1.5");
        let infinite = Outcome { reward: f64::INFINITY, ..outcome(1.0, 1) };
        assert_eq!(error(vec![infinite]), "P[0][0][0] must have a finite reward, got inf");
        let mdp = TabularMdp::new(1, &[0.5, f64::NAN], &[vec![outcome(1.0, 1)], vec![outcome(1.0, 0)]]);
        assert!(mdp.is_err_and(|error| error.to_string().starts_with("initial_state_distrib[1] must")));
        assert!(TabularMdp::new(2, &[1.0], &[vec![outcome(1.0, 0)]]).is_err());
    }

    proptest! {
        #[test]
        fn sampling_matches_categorical_sample(
            probabilities in probabilities(prop_oneof![0.0..1.0, Just(0.0)], 12),
            place in 0.0..1.0,
            at_a_sum in any::<prop::sample::Index>(),
        ) {
            let mut sum = 0.0;
            let sums: Vec<f64> = probabilities.iter().map(|probability| { sum += probability; sum }).collect();
            let outcomes = (0..).zip(&probabilities).map(|(state, &probability)| outcome(probability, state)).collect();
            let rest = vec![vec![outcome(1.0, 0)]; probabilities.len() - 1];
            let table = TabularMdp::new(1, &probabilities, &[vec![outcomes], rest].concat()).expect("a valid table");
            let sum = at_a_sum.get(&sums);
            // Draws are multiples of 2⁻⁵³. Those next to a cumulative sum matter most.
            for random in [place, *sum, sum - 2.0 / TWO_POW_53, 1.0 - 1.0 / TWO_POW_53] {
                let random = ((random * TWO_POW_53).round() / TWO_POW_53).clamp(0.0, 1.0 - 1.0 / TWO_POW_53);
                let expected = sums.iter().position(|&sum| sum > random).unwrap_or(0) as u32;
                prop_assert_eq!(table.step(0, 0, &mut Given(&[random])).state, expected);
                prop_assert_eq!(table.reset(&mut Given(&[random])), expected);
            }
        }
    }
}
