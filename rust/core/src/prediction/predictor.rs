//! A learner that follows a given policy and estimates its values.

use super::{FixedPolicy, LinearValues, PredictionRule, PredictionStep};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::learners::Learner;
use crate::memory::AllocationError;
use crate::random::Rng;
use crate::schedules::StepSize;
use crate::tasks::Next;

/// A prediction method as a [`Learner`]: its actions come from a policy that does not change, and its table has one column.
/// The active row of an observation is the number of its state; the values may have other features.
#[derive(Clone, Debug)]
pub struct Predictor<U> {
    /// The estimated values.
    pub values: LinearValues,
    /// The policy that chooses the actions.
    pub behavior: FixedPolicy,
    /// The method.
    pub rule: U,
}

/// The number of a state.
#[inline]
fn state_of<R: AsRef<[u32]>>(rows: &R) -> u32 {
    rows.as_ref()[0]
}

impl<R: AsRef<[u32]> + Copy, U: PredictionRule> Learner<R> for Predictor<U> {
    #[inline]
    fn first_action(&mut self, state: R, rng: &mut impl Rng) -> usize {
        self.behavior.choose(state_of(&state), rng)
    }

    #[inline]
    fn learn(&mut self, state: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize {
        let next = match next {
            Next::NonTerminal(state) => Next::NonTerminal(state_of(&state)),
            Next::Truncated(state) => Next::Truncated(state_of(&state)),
            Next::Terminal => Next::Terminal,
        };
        self.rule.learn(&mut self.values, PredictionStep { state: state_of(&state), action, reward, next });
        if let Next::NonTerminal(state) = next { self.behavior.choose(state, rng) } else { 0 }
    }

    #[inline]
    fn work(&self) -> u64 {
        self.rule.work()
    }

    fn reserve(&mut self, work: u64) -> Result<(), AllocationError> {
        self.rule.reserve(work)
    }

    #[inline]
    fn is_unfinished(&self) -> bool {
        self.rule.is_unfinished()
    }

    /// Only the last step of an episode is ever unfinished, so no action follows.
    fn resume(&mut self, _next: Next<R>, _rng: &mut impl Rng) -> usize {
        self.rule.resume(&mut self.values);
        0
    }

    fn end_episode(&mut self) {
        self.rule.end_episode(&mut self.values);
        self.values.learning_rate.end_episode();
    }

    fn tables(&self) -> Vec<&[f64]> {
        vec![&self.values.weights]
    }

    fn tables_mut(&mut self) -> Vec<&mut [f64]> {
        vec![&mut self.values.weights]
    }

    fn shape(&self) -> (usize, usize) {
        (self.values.weights.len(), 1)
    }

    fn skip_episodes(&mut self, episodes: usize) {
        (0..episodes).for_each(|_| self.values.learning_rate.end_episode());
    }

    fn abandon_episode(&mut self) {}

    /// A prediction has no checkpoints.
    fn persist(&mut self, _checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        Err(CheckpointError::Invalid("prediction, which is not resumed"))
    }

    fn diverged(&self) -> bool {
        self.values.diverged()
    }
}
