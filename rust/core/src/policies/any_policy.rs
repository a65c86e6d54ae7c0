//! How actions are chosen from their values.

use super::Policy;
use super::Softmax;
use super::TieBreaking;
use super::tie_breaking::any;
use crate::numeric::sum;

use crate::random::Rng;
use crate::schedules::Schedule;

/// Any of the ways, chosen at run time.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyPolicy {
    /// Mostly the greedy action, sometimes any (Sutton & Barto, section 2.2).
    EpsilonGreedy {
        /// ε.
        epsilon: Schedule,
        /// Which of several greedy actions.
        ties: TieBreaking,
    },
    /// The same among the actions that a state has: a value of -∞ stands for one that it has not.
    MaskedEpsilonGreedy {
        /// ε.
        epsilon: Schedule,
        /// Which of several greedy actions.
        ties: TieBreaking,
    },
    /// Each action by exp(Q / τ) (Sutton & Barto, equation 2.11, with a temperature).
    Softmax(Softmax),
}

impl AnyPolicy {
    /// Softmax over so many actions.
    pub fn softmax(temperature: f64, actions: usize) -> Self {
        Self::Softmax(Softmax { temperature, shares: vec![0.0; actions] })
    }
}

impl Policy for AnyPolicy {
    /// One `random()` at every decision; then one `integers` where it explores, or to choose among equals.
    #[inline]
    fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize {
        match self {
            Self::EpsilonGreedy { epsilon, ties } => {
                if rng.random() >= 1.0 - epsilon.value() {
                    rng.integers(values.len() as u32) as usize
                } else {
                    ties.greedy(values, rng)
                }
            }
            Self::MaskedEpsilonGreedy { epsilon, ties } => {
                if rng.random() >= 1.0 - epsilon.value() {
                    any(values, is_there, rng)
                } else {
                    ties.greedy(values, rng)
                }
            }
            Self::Softmax(softmax) => softmax.choose(values, rng),
        }
    }

    #[inline]
    fn expected(&mut self, values: &[f64]) -> f64 {
        match self {
            Self::EpsilonGreedy { epsilon, ties } => ties.expected(epsilon.value(), values.iter().copied()),
            Self::MaskedEpsilonGreedy { epsilon, ties } => {
                ties.expected(epsilon.value(), values.iter().copied().filter(is_there))
            }
            Self::Softmax(softmax) => {
                sum(softmax.shares(values).iter().zip(values).map(|(share, value)| share * value))
            }
        }
    }

    fn end_episode(&mut self) {
        if let Self::EpsilonGreedy { epsilon, .. } | Self::MaskedEpsilonGreedy { epsilon, .. } = self {
            epsilon.end_episode();
        }
    }
}

/// Whether a state has the action of this value.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "filters hand out references")]
#[inline]
fn is_there(value: &f64) -> bool {
    *value != f64::NEG_INFINITY
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::policies::EpsilonGreedy;
    use crate::random::{Pcg64, SeedSequence};

    fn greedy(ties: TieBreaking) -> AnyPolicy {
        AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(0.25), ties }
    }

    #[test]
    fn the_expected_value_weighs_the_greedy_action_most() {
        // (1/16 + 3/4) 4 + 1/16 (2 + 0 - 1)
        assert_eq!(greedy(TieBreaking::First).expected(&[2.0, 4.0, 0.0, -1.0]), 3.3125);
        assert_eq!(EpsilonGreedy::linear(0.25, 0.25, 1).expected(&[2.0, 4.0, 0.0, -1.0]), 3.3125);
    }

    #[test]
    fn softmax_weighs_by_the_exponential() {
        let mut softmax = AnyPolicy::softmax(1.0, 2);
        let expected = softmax.expected(&[0.0, 3.0_f64.ln()]);
        assert!((expected - 0.75 * 3.0_f64.ln()).abs() < 1e-15);
    }

    #[test]
    fn an_action_that_is_not_there_is_neither_chosen_nor_counted() {
        let values = [2.0, f64::NEG_INFINITY, -1.0, f64::NEG_INFINITY];
        let mut some = AnyPolicy::MaskedEpsilonGreedy { epsilon: Schedule::constant(1.0), ties: TieBreaking::First };
        let mut rng = Pcg64::new(&SeedSequence::new(&[1]));
        let mut counts = [0; 4];
        for _ in 0..1000 {
            counts[some.choose(&values, &mut rng)] += 1;
        }
        assert!(counts[0] > 400 && counts[2] > 400 && counts[1] + counts[3] == 0);
        assert_eq!(some.expected(&values), 0.5);
    }
}
