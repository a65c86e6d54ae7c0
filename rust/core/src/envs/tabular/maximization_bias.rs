//! The maximization bias example (Sutton & Barto, Example 6.7 and Figure 6.5).
//!
//! Every episode begins in A. Right ends it with a reward of 0. Left leads to B with a reward of 0, and from B every
//! action ends the episode with a normally distributed reward whose mean is negative. So left is always a mistake.

use crate::envs::{Env, Step};
use crate::random::Rng;

const A: u32 = 0;
const B: u32 = 1;
/// The terminal state.
const END: u32 = 2;
/// The number of states.
pub const STATES: u32 = 3;
/// The action "right" in A. Every other action is "left", because A has as many actions as B.
const RIGHT: usize = 0;

/// The parameters of the example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaximizationBias {
    /// The number of actions in B ("many" in the book).
    pub num_actions: usize,
    /// The mean of the rewards in B.
    pub mean: f64,
    /// The standard deviation of the rewards in B.
    pub standard_deviation: f64,
}

impl MaximizationBias {
    /// A normally distributed reward, from two draws u, v of `random()`: √(-2 ln(1 - u)) cos 2πv (G. Box and M. Muller,
    /// 1958). It works with any generator. `NumPy`'s `normal` uses another method and returns other numbers.
    fn reward(&self, rng: &mut impl Rng) -> f64 {
        let (u, v) = (rng.random(), rng.random());
        self.mean + self.standard_deviation * ((-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos())
    }
}

impl Env for MaximizationBias {
    type State = u32;
    type Action = usize;
    type Observation = u32;

    #[inline]
    fn num_actions(&self) -> usize {
        self.num_actions
    }

    #[inline]
    fn reset(&self, _rng: &mut impl Rng) -> u32 {
        A
    }

    #[inline]
    fn step(&self, state: u32, action: usize, rng: &mut impl Rng) -> Step<u32> {
        match state {
            A if action == RIGHT => Step { state: END, reward: 0.0, terminated: true },
            A => Step { state: B, reward: 0.0, terminated: false },
            _ => Step { state: END, reward: self.reward(rng), terminated: true },
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

    const BOOK: MaximizationBias = MaximizationBias { num_actions: 10, mean: -0.1, standard_deviation: 1.0 };

    #[test]
    fn right_ends_the_episode_and_left_leads_to_b() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let start = BOOK.reset(&mut rng);
        assert_eq!(BOOK.step(start, 0, &mut rng), Step { state: END, reward: 0.0, terminated: true });
        assert_eq!(BOOK.step(start, 1, &mut rng), Step { state: B, reward: 0.0, terminated: false });
        assert_eq!(rng.words_drawn(), 0);
    }

    #[test]
    fn rewards_in_b_have_the_given_mean_and_deviation() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let rewards: Vec<f64> = (0..100_000).map(|action| BOOK.step(B, action % 10, &mut rng).reward).collect();
        let mean = rewards.iter().sum::<f64>() / 1e5;
        let variance = rewards.iter().map(|reward| (reward - mean).powi(2)).sum::<f64>() / 1e5;
        // Within three standard errors.
        assert!((mean + 0.1).abs() < 0.0095 && (variance - 1.0).abs() < 0.0135);
    }
}
