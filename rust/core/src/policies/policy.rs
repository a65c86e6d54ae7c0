//! The trait of all policies.

use crate::random::Rng;

/// A way of choosing actions.
pub trait Policy {
    /// Chooses among the actions of these values.
    fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize;

    /// Σₐ π(a) Q(a), from the left: what the choice is worth on average.
    fn expected(&mut self, values: &[f64]) -> f64;

    /// Called after every episode.
    fn end_episode(&mut self);
}
