//! A learner that follows a given policy and estimates its values.

use super::{Behavior, FixedPolicy, LinearValues, PredictionRule, PredictionStep, RowSets, StateRows};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::learners::Learner;
use crate::memory::{AllocationError, RunMemory};
use crate::random::Rng;
use crate::schedules::StepSize;
use crate::tasks::Next;

/// A prediction method as a [`Learner`]: its actions come from a policy that does not change, and its table has one column.
/// The active row of an observation is the number of its state, which may have other features; or the observation has
/// features without a number.
#[derive(Clone, Debug)]
pub struct Predictor<U, B = FixedPolicy, S = StateRows> {
    /// The estimated values.
    pub values: LinearValues<S>,
    /// Where the actions come from.
    pub behavior: B,
    /// The method.
    pub rule: U,
}

impl<R, U, B, S> Learner<R> for Predictor<U, B, S>
where
    R: AsRef<[u32]> + Copy,
    U: PredictionRule<S>,
    B: Behavior<R>,
    S: RowSets,
{
    #[inline]
    fn first_action(&mut self, state: R, rng: &mut impl Rng) -> usize {
        let number = self.values.rows.begin(state.as_ref());
        self.behavior.action(number, &state, rng)
    }

    #[inline]
    fn learn(&mut self, state: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize {
        if B::HAS_RATIOS {
            self.rule.weigh(self.behavior.ratio(&state));
        }
        let rows = &mut self.values.rows;
        let number = rows.current(state.as_ref());
        let next_number = match next {
            Next::NonTerminal(next) => Next::NonTerminal(rows.visit_next(next.as_ref())),
            Next::Truncated(next) => Next::Truncated(rows.visit_next(next.as_ref())),
            Next::Terminal => Next::Terminal,
        };
        self.rule.learn(&mut self.values, PredictionStep { state: number, action, reward, next: next_number });
        let Next::NonTerminal(next) = next else { return 0 };
        self.behavior.action(self.values.rows.current(next.as_ref()), &next, rng)
    }

    #[inline]
    fn work(&self) -> u64 {
        self.rule.work()
    }

    fn reserve(&mut self, work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        self.values.rows.reserve(work, memory)?;
        self.rule.reserve(work, memory)
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
