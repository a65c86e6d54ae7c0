//! Where the actions of a prediction come from.

use super::{FixedPolicy, Observed};
use crate::random::Rng;

/// The policy that acts, or a task that has one. `R` holds the active rows of a state.
pub trait Behavior<R> {
    /// Whether the target policy is another one, and the actions come with the ratios of their probabilities.
    const HAS_RATIOS: bool;

    /// The action in a state, of which the number is given, too.
    fn action(&self, state: u32, active: &R, rng: &mut impl Rng) -> usize;

    /// π(A|S) / b(A|S) of that action.
    fn ratio(&self, active: &R) -> f64;
}

/// A policy over numbered states. Methods that need ratios read its table themselves.
impl<R> Behavior<R> for FixedPolicy {
    const HAS_RATIOS: bool = false;

    #[inline]
    fn action(&self, state: u32, _active: &R, rng: &mut impl Rng) -> usize {
        self.choose(state, rng)
    }

    #[inline]
    fn ratio(&self, _active: &R) -> f64 {
        1.0
    }
}

/// The actions that a [`PolicyTask`](super::PolicyTask) brings along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FromTask;

impl<R> Behavior<Observed<R>> for FromTask {
    const HAS_RATIOS: bool = true;

    #[inline]
    fn action(&self, _state: u32, active: &Observed<R>, _rng: &mut impl Rng) -> usize {
        active.choice.action as usize
    }

    #[inline]
    fn ratio(&self, active: &Observed<R>) -> f64 {
        active.choice.ratio
    }
}
