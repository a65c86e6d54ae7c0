//! The trait of all policies.

use crate::random::Rng;

/// A policy π over action values.
pub trait Policy {
    /// Samples an action from π, given the values of all actions.
    fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize;

    /// The expected value Σₐ π(a) Q(a), summed from left to right.
    fn expected_value(&mut self, values: &[f64]) -> f64;

    /// The probability π(a) of an action.
    fn probability(&mut self, values: &[f64], action: usize) -> f64;

    /// Called after every episode.
    fn end_episode(&mut self);
}
