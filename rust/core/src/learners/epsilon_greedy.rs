//! Mostly the greedy action, sometimes any (Sutton & Barto, section 2.2), with the article's linear decay.

use crate::random::Draw;
use crate::table::first_maximum;

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
    pub fn choose(&self, values: &[f64], draw: &mut impl Draw) -> usize {
        if draw.random() < 1.0 - self.epsilon {
            first_maximum(values)
        } else {
            draw.integers(values.len() as u32) as usize
        }
    }

    /// Not clamped, as in the article: it may end a few 1e-14 past the minimum.
    pub fn end_episode(&mut self) {
        if self.epsilon > self.min_epsilon {
            self.epsilon -= self.reduction;
        }
    }
}
