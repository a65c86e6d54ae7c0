//! An example of maximisation bias (Sutton & Barto, 2nd ed., Example 6.7 and Figure 6.5).
//!
//! Every episode begins in A. Right ends it without a reward. Left leads to B, equally without one; from there every
//! action ends it with a normal reward whose mean lies below zero, so that left is always a mistake.

use crate::envs::{Env, Step};
use crate::random::Rng;

const A: u32 = 0;
const B: u32 = 1;
/// The third is terminal.
const END: u32 = 2;
/// How many states there are.
pub const STATES: u32 = 3;
/// Of A's two actions. Whoever takes a third one there goes left, too.
const RIGHT: usize = 0;

/// How many actions B has, and how it rewards them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaximizationBias {
    /// "Many", the book says.
    pub actions: usize,
    /// The mean of B's rewards.
    pub mean: f64,
    /// Their standard deviation.
    pub deviation: f64,
}

impl Env for MaximizationBias {
    type State = u32;
    type Action = usize;
    type Observation = u32;

    #[inline]
    fn num_actions(&self) -> usize {
        self.actions
    }

    #[inline]
    fn reset(&self, _draw: &mut impl Rng) -> u32 {
        A
    }

    #[inline]
    fn step(&self, state: u32, action: usize, rng: &mut impl Rng) -> Step<u32> {
        match state {
            A if action == RIGHT => Step { state: END, reward: 0.0, terminated: true },
            A => Step { state: B, reward: 0.0, terminated: false },
            _ => Step { state: END, reward: rng.normal(self.mean, self.deviation), terminated: true },
        }
    }

    #[inline]
    fn observe(&self, &state: &u32) -> u32 {
        state
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    const BOOK: MaximizationBias = MaximizationBias { actions: 10, mean: -0.1, deviation: 1.0 };

    #[test]
    fn right_ends_it_for_nothing_and_left_leads_on() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let start = BOOK.reset(&mut rng);
        assert_eq!(BOOK.step(start, 0, &mut rng), Step { state: END, reward: 0.0, terminated: true });
        assert_eq!(BOOK.step(start, 1, &mut rng), Step { state: B, reward: 0.0, terminated: false });
        assert_eq!(rng.words_drawn(), 0);
    }

    #[test]
    fn what_lies_left_has_the_mean_and_the_deviation() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let rewards: Vec<f64> = (0..100_000).map(|turn| BOOK.step(B, turn % 10, &mut rng).reward).collect();
        let mean = rewards.iter().sum::<f64>() / 1e5;
        let variance = rewards.iter().map(|reward| (reward - mean).powi(2)).sum::<f64>() / 1e5;
        // Three standard errors.
        assert!((mean + 0.1).abs() < 0.0095 && (variance - 1.0).abs() < 0.0135);
    }
}
