//! The trait of all prediction methods, and the learner that follows a given policy and applies one of them.

use super::{FixedPolicy, LinearValues};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::features::{ActiveFeatures, assert_binary};
use crate::learners::Learner;
use crate::memory::{AllocationError, RunMemory};
use crate::random::Rng;
use crate::schedules::StepSize;
use crate::tasks::Next;

/// A step of an episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictionStep {
    /// The number of the state S.
    pub state: u32,
    /// The reward R.
    pub reward: f64,
    /// The number of the next state S′.
    pub next: Next<u32>,
    /// The importance-sampling ratio π(A|S) / b(A|S).
    pub ratio: f64,
}

impl PredictionStep {
    /// Whether this is the last step of the episode, because of a terminal state or the time limit.
    #[inline]
    pub fn is_last(&self) -> bool {
        !matches!(self.next, Next::NonTerminal(_))
    }
}

/// The update rule of a prediction method. It draws no random numbers.
pub trait PredictionRule {
    /// Learns from one step.
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep);

    /// The work of the last call, as counted by [`Budget`](crate::Budget). At least 1.
    fn work(&self) -> u64 {
        1
    }

    /// Whether the last step still has work to do, which `resume` continues.
    fn is_unfinished(&self) -> bool {
        false
    }

    /// Continues to learn from the last step.
    fn resume(&mut self, _values: &mut LinearValues) {}

    /// The number of states before the last one that are still needed; `None` for all states of the episode.
    fn look_back(&self) -> Option<usize> {
        None
    }

    /// Called after the last step of every episode.
    fn end_episode(&mut self) {}

    /// Reserves memory for the data of this many steps.
    ///
    /// # Errors
    /// `OutOfMemory`, `LimitReached`.
    fn reserve(&mut self, _steps: u64, _memory: &mut RunMemory) -> Result<(), AllocationError> {
        Ok(())
    }
}

/// The behavior policy b. `R` holds the active rows of a state.
pub trait Behavior<R> {
    /// Whether it is a policy over numbered states: the active row in the task is then the number of a state.
    const OF_STATES: bool;

    /// Samples an action in a state, which is given by its number and by its active rows.
    fn action(&self, state: u32, active: &R, rng: &mut impl Rng) -> usize;

    /// π(A|S) / b(A|S) of an action.
    fn ratio(&self, state: u32, active: &R, action: usize) -> f64;
}

/// A prediction method as a [`Learner`]. The actions come from a policy that does not change, and the table has one
/// column.
#[derive(Debug)]
pub struct Predictor<U: ?Sized, B = FixedPolicy> {
    /// The estimated values.
    pub(super) values: LinearValues,
    behavior: B,
    /// The method.
    pub(super) rule: Box<U>,
    /// The number of the state visited last, if the task does not number its states.
    state: u32,
}

impl<U: ?Sized, B> Predictor<U, B> {
    /// A learner before its first episode.
    pub fn new(values: LinearValues, behavior: B, rule: Box<U>) -> Self {
        Self { values, behavior, rule, state: 0 }
    }

    /// The number of the next state of the episode.
    #[inline]
    fn visit<R: ActiveFeatures>(&mut self, active: &R) -> u32
    where
        B: Behavior<R>,
    {
        if B::OF_STATES {
            assert_binary::<R>();
        } else {
            self.state = self.values.features.visit(active);
        }
        self.last_visit(active)
    }

    /// The number of the state visited last.
    #[inline]
    fn last_visit<R: ActiveFeatures>(&self, active: &R) -> u32
    where
        B: Behavior<R>,
    {
        if B::OF_STATES { active.as_ref()[0] } else { self.state }
    }
}

impl<R: ActiveFeatures + Copy, U: PredictionRule + ?Sized, B: Behavior<R>> Learner<R> for Predictor<U, B> {
    #[inline]
    fn first_action(&mut self, active: R, rng: &mut impl Rng) -> usize {
        self.values.features.begin();
        let state = self.visit(&active);
        self.behavior.action(state, &active, rng)
    }

    #[inline]
    fn learn(&mut self, active: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize {
        let state = self.last_visit(&active);
        let next_state = match next {
            Next::NonTerminal(next) => Next::NonTerminal(self.visit(&next)),
            Next::Truncated(next) => Next::Truncated(self.visit(&next)),
            Next::Terminal => Next::Terminal,
        };
        let ratio = self.behavior.ratio(state, &active, action);
        self.rule.learn(&mut self.values, PredictionStep { state, reward, next: next_state, ratio });
        let Next::NonTerminal(next) = next else { return 0 };
        self.behavior.action(self.last_visit(&next), &next, rng)
    }

    #[inline]
    fn work(&self) -> u64 {
        self.rule.work()
    }

    fn reserve(&mut self, work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        self.values.features.reserve(work, memory)?;
        self.rule.reserve(work, memory)
    }

    #[inline]
    fn is_unfinished(&self) -> bool {
        self.rule.is_unfinished()
    }

    /// Only the last step of an episode can be unfinished, so no action follows.
    fn resume(&mut self, _next: Next<R>, _rng: &mut impl Rng) -> usize {
        self.rule.resume(&mut self.values);
        0
    }

    fn end_episode(&mut self) {
        self.rule.end_episode();
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

    fn abandon_episode(&mut self) {}

    /// A prediction has no checkpoints.
    fn persist(&mut self, _checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        Err(CheckpointError::Invalid("prediction, which is not resumed"))
    }

    fn diverged(&self) -> bool {
        self.values.diverged()
    }
}
