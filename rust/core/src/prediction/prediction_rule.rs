//! The trait of all prediction methods.

use super::{LinearValues, StateRows};
use crate::memory::{AllocationError, RunMemory};
use crate::tasks::Next;

/// A step: the state, the action taken in it, the reward and what followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictionStep {
    /// The number of the state.
    pub state: u32,
    /// The action.
    pub action: usize,
    /// The reward.
    pub reward: f64,
    /// What followed.
    pub next: Next<u32>,
}

impl PredictionStep {
    /// Whether the episode ends here, in a terminal state or by its time limit.
    #[inline]
    pub fn is_last(&self) -> bool {
        !matches!(self.next, Next::NonTerminal(_))
    }
}

/// How a method changes the values. It draws no random numbers.
pub trait PredictionRule<S = StateRows> {
    /// Learns from one step.
    fn learn(&mut self, values: &mut LinearValues<S>, step: PredictionStep);

    /// The work of the last call, as [`Budget`](crate::Budget) counts it. At least 1.
    fn work(&self) -> u64 {
        1
    }

    /// Whether the last step still has work to do, which `resume` continues.
    fn is_unfinished(&self) -> bool {
        false
    }

    /// Continues to learn from the last step.
    fn resume(&mut self, _values: &mut LinearValues<S>) {}

    /// Takes π(A|S) / b(A|S) of the step that is learned from next, where the policies are not tables.
    fn weigh(&mut self, _ratio: f64) {}

    /// How many states before the last one are still needed; `None` for all of the episode.
    fn look_back(&self) -> Option<usize> {
        None
    }

    /// Called after the last step of every episode.
    fn end_episode(&mut self, _values: &mut LinearValues<S>) {}

    /// Makes room for what so many steps store.
    ///
    /// # Errors
    /// `OutOfMemory`, `LimitReached`.
    fn reserve(&mut self, _steps: u64, _memory: &mut RunMemory) -> Result<(), AllocationError> {
        Ok(())
    }
}

impl<S> PredictionRule<S> for Box<dyn PredictionRule<S> + Send> {
    fn learn(&mut self, values: &mut LinearValues<S>, step: PredictionStep) {
        (**self).learn(values, step);
    }

    fn work(&self) -> u64 {
        (**self).work()
    }

    fn is_unfinished(&self) -> bool {
        (**self).is_unfinished()
    }

    fn resume(&mut self, values: &mut LinearValues<S>) {
        (**self).resume(values);
    }

    fn weigh(&mut self, ratio: f64) {
        (**self).weigh(ratio);
    }

    fn look_back(&self) -> Option<usize> {
        (**self).look_back()
    }

    fn end_episode(&mut self, values: &mut LinearValues<S>) {
        (**self).end_episode(values);
    }

    fn reserve(&mut self, steps: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        (**self).reserve(steps, memory)
    }
}
