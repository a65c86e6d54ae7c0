//! The trait of all policies.

use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::features::{ActiveFeatures, assert_binary};
use crate::random::Rng;

/// Checks that the policy can choose in a state with these features. The compiler removes the check for binary features.
///
/// # Panics
/// For weighted features, if the policy counts its choices.
#[inline(always)]
#[track_caller]
pub(crate) fn assert_takes<R: ActiveFeatures>(policy: &impl Policy, _rows: &R) {
    if R::WEIGHTED && policy.counts_choices() {
        assert_binary::<R>();
    }
}

/// A policy π over action values.
pub trait Policy {
    /// Samples an action from π, given the values of all actions.
    fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize;

    /// [`choose`](Self::choose) in the state with these active rows, for policies that count their choices in each
    /// state.
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn choose_in(&mut self, _rows: &[u32], values: &[f64], rng: &mut impl Rng) -> usize {
        self.choose(values, rng)
    }

    /// The expected value Σₐ π(a) Q(a), summed from left to right.
    fn expected_value(&mut self, values: &[f64]) -> f64;

    /// [`expected_value`](Self::expected_value) in the state with these active rows.
    #[inline]
    fn expected_value_in(&mut self, _rows: &[u32], values: &[f64]) -> f64 {
        self.expected_value(values)
    }

    /// The probability π(a) of an action, for policies that do not count.
    fn probability(&mut self, values: &[f64], action: usize) -> f64;

    /// Whether the policy counts its choices in each row. It then needs binary features.
    fn counts_choices(&self) -> bool {
        false
    }

    /// Saves or restores the counts.
    ///
    /// # Errors
    /// The bytes are damaged.
    fn persist_counts(&mut self, _checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        Ok(())
    }

    /// Called after every episode.
    fn end_episode(&mut self);
}
