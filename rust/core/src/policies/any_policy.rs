//! A policy chosen at run time.

use super::{Policy, Softmax, TieBreaking, Ucb};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::random::Rng;
use crate::schedules::Schedule;

/// One of the policies, chosen at run time.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum AnyPolicy {
    /// The ε-greedy policy (Sutton & Barto, section 2.2).
    EpsilonGreedy {
        /// The exploration rate ε.
        epsilon: Schedule,
        /// The rule for ties between greedy actions.
        ties: TieBreaking,
    },
    /// The ε-greedy policy over the available actions only. The value of an unavailable action is -∞.
    MaskedEpsilonGreedy {
        /// The exploration rate ε.
        epsilon: Schedule,
        /// The rule for ties between greedy actions.
        ties: TieBreaking,
    },
    /// The softmax policy (Sutton & Barto, equation 2.11).
    Softmax(Softmax),
    /// Upper-confidence-bound action selection (Sutton & Barto, section 2.7), for one active row.
    Ucb(Ucb),
}

impl AnyPolicy {
    /// The softmax policy over `num_actions` actions.
    pub fn softmax(temperature: f64, num_actions: usize) -> Self {
        Self::Softmax(Softmax::new(temperature, num_actions))
    }

    /// [`Policy::choose_in`] for the policies that are not compiled into the learners. `row` is the first active row.
    fn choose_otherwise(&mut self, row: u32, values: &[f64], rng: &mut impl Rng) -> usize {
        match self {
            Self::EpsilonGreedy { .. } => self.choose(values, rng),
            Self::MaskedEpsilonGreedy { epsilon, ties } => {
                if rng.random() >= 1.0 - epsilon.value() {
                    random_available_action(values, rng)
                } else {
                    ties.greedy(values, rng)
                }
            }
            Self::Softmax(softmax) => softmax.choose(values, rng),
            Self::Ucb(ucb) => ucb.choose(row, values, rng),
        }
    }

    /// [`Policy::expected_value_in`] for the policies that are not compiled into the learners. `row` is the first active one.
    fn expected_value_otherwise(&mut self, row: u32, values: &[f64]) -> f64 {
        match self {
            Self::EpsilonGreedy { .. } => self.expected_value(values),
            Self::MaskedEpsilonGreedy { epsilon, ties } => {
                ties.expected_value(epsilon.value(), values.iter().copied().filter(is_available))
            }
            Self::Softmax(softmax) => softmax.expected_value(values),
            Self::Ucb(ucb) => ucb.expected_value(row, values),
        }
    }

    /// The gradient of ln π(A) with respect to the preferences of the actions; 0 for policies other than the softmax.
    pub(crate) fn log_gradient(&mut self, values: &[f64], action: usize) -> &[f64] {
        if let Self::Softmax(softmax) = self { softmax.log_gradient(values, action) } else { &[] }
    }
}

impl Policy for AnyPolicy {
    /// Draws one `random()`. The ε-greedy policies then draw one `integers` if they explore, or to break a tie.
    #[expect(
        clippy::inline_always,
        reason = "where the number of actions is known, a call per step would take a third of its time"
    )]
    #[inline(always)]
    fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize {
        let Self::EpsilonGreedy { epsilon, ties } = self else { return self.choose_otherwise(0, values, rng) };
        if rng.random() >= 1.0 - epsilon.value() {
            rng.integers(values.len() as u32) as usize
        } else {
            ties.greedy(values, rng)
        }
    }

    #[expect(
        clippy::inline_always,
        reason = "where the number of actions is known, a call per step would take a third of its time"
    )]
    #[inline(always)]
    fn choose_in(&mut self, rows: &[u32], values: &[f64], rng: &mut impl Rng) -> usize {
        match self {
            Self::EpsilonGreedy { .. } => self.choose(values, rng),
            _ => self.choose_otherwise(rows[0], values, rng),
        }
    }
    #[inline]
    fn expected_value(&mut self, values: &[f64]) -> f64 {
        self.expected_value_in(&[0], values)
    }

    fn probability(&mut self, values: &[f64], action: usize) -> f64 {
        match self {
            Self::EpsilonGreedy { epsilon, ties } => ties.probability(epsilon.value(), values, values.len(), action),
            // The action was taken before the mask of its state changed.
            Self::MaskedEpsilonGreedy { .. } if !is_available(&values[action]) => 0.0,
            Self::MaskedEpsilonGreedy { epsilon, ties } => {
                let count = values.iter().filter(|&value| is_available(value)).count();
                ties.probability(epsilon.value(), values, count, action)
            }
            Self::Softmax(softmax) => softmax.probability(values, action),
            // UCB has already counted its choice; no learner that needs probabilities is combined with it.
            Self::Ucb(_) => 1.0,
        }
    }

    #[expect(clippy::inline_always, reason = "a call takes 3 % more instructions per step of Expected Sarsa")]
    #[inline(always)]
    fn expected_value_in(&mut self, rows: &[u32], values: &[f64]) -> f64 {
        match self {
            Self::EpsilonGreedy { epsilon, ties } => ties.expected_value(epsilon.value(), values.iter().copied()),
            _ => self.expected_value_otherwise(rows[0], values),
        }
    }

    fn counts_choices(&self) -> bool {
        matches!(self, Self::Ucb(_))
    }

    fn persist_counts(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        if let Self::Ucb(ucb) = self { ucb.persist_counts(checkpoint) } else { Ok(()) }
    }

    fn end_episode(&mut self) {
        if let Self::EpsilonGreedy { epsilon, .. } | Self::MaskedEpsilonGreedy { epsilon, .. } = self {
            epsilon.end_episode();
        }
    }
}

/// A random available action.
#[inline]
pub(crate) fn random_available_action(values: &[f64], rng: &mut impl Rng) -> usize {
    let actions = || values.iter().enumerate().filter(|(_, value)| is_available(value)).map(|(action, _)| action);
    let chosen = rng.integers(actions().count() as u32) as usize;
    // The first action, if none is available.
    actions().nth(chosen).unwrap_or(0)
}

/// Whether an action with this value is available.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "`Iterator::filter` passes references")]
#[inline]
pub(super) fn is_available(value: &f64) -> bool {
    *value != f64::NEG_INFINITY
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::policies::EpsilonGreedy;
    use crate::random::{Pcg64, SeedSequence};

    fn epsilon_greedy(ties: TieBreaking) -> AnyPolicy {
        AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(0.25), ties }
    }

    #[test]
    fn the_expected_value_weighs_the_greedy_action_most() {
        // (1/16 + 3/4) 4 + 1/16 (2 + 0 - 1)
        assert_eq!(epsilon_greedy(TieBreaking::First).expected_value(&[2.0, 4.0, 0.0, -1.0]), 3.3125);
        assert_eq!(EpsilonGreedy::linear(0.25, 0.25, 1).expected_value(&[2.0, 4.0, 0.0, -1.0]), 3.3125);
    }

    #[test]
    fn probabilities_share_what_is_greedy_as_ties_are_broken() {
        let values = [4.0, 4.0, 0.0, -1.0];
        let probabilities = |ties| [0, 1, 2].map(|action| epsilon_greedy(ties).probability(&values, action));
        assert_eq!(probabilities(TieBreaking::First), [0.8125, 0.0625, 0.0625]);
        assert_eq!(probabilities(TieBreaking::Random), [0.4375, 0.4375, 0.0625]);
        assert_eq!(EpsilonGreedy::linear(0.25, 0.25, 1).probability(&values, 0), 0.8125);
        let masked = [4.0, 4.0, f64::NEG_INFINITY, -1.0];
        let mut policy = AnyPolicy::MaskedEpsilonGreedy { epsilon: Schedule::constant(0.75), ties: TieBreaking::First };
        assert_eq!([0, 2, 3].map(|action| policy.probability(&masked, action)), [0.5, 0.0, 0.25]);
        assert_eq!(AnyPolicy::softmax(1.0, 4).probability(&[0.0; 4], 3), 0.25);
    }

    #[test]
    fn an_unavailable_action_is_neither_chosen_nor_counted() {
        let values = [2.0, f64::NEG_INFINITY, -1.0, f64::NEG_INFINITY];
        let mut masked = AnyPolicy::MaskedEpsilonGreedy { epsilon: Schedule::constant(1.0), ties: TieBreaking::First };
        let mut rng = Pcg64::new(&SeedSequence::new(&[1]));
        let mut counts = [0; 4];
        for _ in 0..1000 {
            counts[masked.choose(&values, &mut rng)] += 1;
        }
        assert!(counts[0] > 400 && counts[2] > 400 && counts[1] + counts[3] == 0);
        assert_eq!(masked.expected_value(&values), 0.5);
    }
}
