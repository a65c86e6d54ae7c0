//! Environments that know the probability of each step.

use super::{Env, Step};
use crate::random::Rng;

/// An environment whose steps have probabilities.
pub trait TransitionProbability: Env {
    /// One step, and how likely it was.
    fn step_with_probability(
        &self,
        state: Self::State,
        action: Self::Action,
        rng: &mut impl Rng,
    ) -> (Step<Self::State>, f64);
}
