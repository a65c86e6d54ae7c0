//! The trait of environments that know the probability of each step.

use super::{Env, Step};
use crate::random::Rng;

/// An environment that knows the probability of each step, as Gymnasium's toy text environments report it in `info`.
pub trait TransitionProbability: Env {
    /// One step, and the probability of what was sampled.
    fn step_with_probability(
        &self,
        state: Self::State,
        action: Self::Action,
        rng: &mut impl Rng,
    ) -> (Step<Self::State>, f64);
}
