//! The ε-greedy policy with the article's linear decay.

use std::hint::select_unpredictable;

use super::{Policy, TieBreaking};
use crate::numeric::{argmax, sum};
use crate::random::Rng;
use crate::schedules::Schedule;

/// The ε-greedy policy (Sutton & Barto, section 2.2): a random action with probability ε, otherwise the greedy action,
/// or the first of several with the maximal value. ε falls by a constant after every episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpsilonGreedy {
    epsilon: Schedule,
}

impl EpsilonGreedy {
    /// ε falls from `epsilon` to `min_epsilon` over `episodes` episodes.
    ///
    /// # Panics
    /// If `episodes` is 0.
    pub fn linear(epsilon: f64, min_epsilon: f64, episodes: u64) -> Self {
        Self { epsilon: Schedule::linear(epsilon, min_epsilon, episodes, 0) }
    }

    /// The probability of the greedy action and that of each other action, for this number of actions.
    #[inline]
    pub(crate) fn probabilities(&self, num_actions: usize) -> (f64, f64) {
        let other = self.epsilon() / num_actions as f64;
        (other + (1.0 - self.epsilon()), other)
    }

    /// The current exploration rate.
    #[inline]
    pub fn epsilon(&self) -> f64 {
        self.epsilon.value()
    }
}

impl Policy for EpsilonGreedy {
    /// Draws one `random()`, even if ε is 0 or 1, then one `integers` if it explores.
    #[inline]
    fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize {
        if rng.random() < 1.0 - self.epsilon() { argmax(values) } else { rng.integers(values.len() as u32) as usize }
    }

    #[inline]
    fn expected_value(&mut self, values: &[f64]) -> f64 {
        let (greedy_probability, other_probability) = self.probabilities(values.len());
        let expected_if_greedy = |greedy| {
            sum(values.iter().enumerate().map(|(action, &value)| {
                if action == greedy { greedy_probability * value } else { other_probability * value }
            }))
        };
        // With few actions it is faster to compute the sum for each possible greedy action while searching for the
        // argmax.
        let best = argmax(values);
        (1..values.len()).fold(expected_if_greedy(0), |found, action| {
            select_unpredictable(action == best, expected_if_greedy(action), found)
        })
    }

    fn probability(&mut self, values: &[f64], action: usize) -> f64 {
        TieBreaking::First.probability(self.epsilon(), values, values.len(), action)
    }

    /// ε is not clamped, as in the article: rounding may leave it a few 1e-14 below its minimum.
    fn end_episode(&mut self) {
        self.epsilon.end_episode();
    }
}
