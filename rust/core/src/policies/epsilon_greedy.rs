//! Mostly the greedy action, sometimes any (Sutton & Barto, section 2.2), with the article's linear decay.

use super::Policy;
use crate::numeric::argmax;
use crate::numeric::sum;
use crate::random::Rng;
use std::hint::select_unpredictable;

/// Explores with probability `epsilon`, which falls by the same amount after every episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpsilonGreedy {
    epsilon: f64,
    min_epsilon: f64,
    reduction: f64,
}

impl EpsilonGreedy {
    /// From `epsilon` down to `min_epsilon` over `episodes` episodes.
    pub fn linear(epsilon: f64, min_epsilon: f64, episodes: u64) -> Self {
        Self { epsilon, min_epsilon, reduction: (epsilon - min_epsilon) / episodes as f64 }
    }

    /// The exploration rate now.
    pub fn epsilon(&self) -> f64 {
        self.epsilon
    }

    /// One `random()` at every decision, at epsilon 0 and 1 too; then one `integers` where it explores.
    #[inline]
    pub fn choose(&self, values: &[f64], rng: &mut impl Rng) -> usize {
        if rng.random() < 1.0 - self.epsilon { argmax(values) } else { rng.integers(values.len() as u32) as usize }
    }

    /// Not clamped, as in the article: it may end a few 1e-14 past the minimum.
    pub fn end_episode(&mut self) {
        if self.epsilon > self.min_epsilon {
            self.epsilon -= self.reduction;
        }
    }
}

impl Policy for EpsilonGreedy {
    #[inline]
    fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize {
        EpsilonGreedy::choose(self, values, rng)
    }

    #[inline]
    fn expected(&mut self, values: &[f64]) -> f64 {
        let any = self.epsilon() / values.len() as f64;
        let greedy = any + (1.0 - self.epsilon());
        let expected = |best| {
            sum(values
                .iter()
                .enumerate()
                .map(|(action, &value)| if action == best { greedy * value } else { any * value }))
        };
        // The answer for each action that might be the greedy one: for a few, sooner than to search first and add then.
        let best = argmax(values);
        (1..values.len())
            .fold(expected(0), |found, action| select_unpredictable(action == best, expected(action), found))
    }

    fn end_episode(&mut self) {
        EpsilonGreedy::end_episode(self);
    }
}
