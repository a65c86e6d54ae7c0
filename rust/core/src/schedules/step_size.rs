//! The trait of all step sizes.

use super::{Schedule, UpdateLog};
use crate::checkpoint::{Checkpoint, CheckpointError};

/// The step size of each weight of a Q table. With several active rows it should be the learning rate divided by their
/// number: [`LearningRate`](super::LearningRate) divides by itself, numbers and schedules do not. The index of a
/// weight is `row * num_actions + action`.
pub trait StepSize {
    /// Counts a visit to a weight, before its update.
    #[inline]
    fn visit(&mut self, _weight_index: usize) {}

    /// The step size, if it is the same for every weight, visits are not counted, and updates are not logged.
    fn uniform(&self) -> Option<f64>;

    /// The step size of a weight.
    fn at(&self, weight_index: usize) -> f64;

    /// The step size of each row, if it depends on the row.
    #[inline]
    fn of_rows(&self) -> Option<&[f64]> {
        None
    }

    /// Called after every episode.
    #[inline]
    fn end_episode(&mut self) {}

    /// The log of updates; `None` if they are not logged.
    #[inline]
    fn log(&mut self) -> Option<&mut UpdateLog> {
        None
    }

    /// Saves or restores the counts of visits, but not the position in the schedule.
    ///
    /// # Errors
    /// The bytes are damaged.
    fn persist_counts(&mut self, _checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        Ok(())
    }
}

/// A constant step size, the same for each active row: unlike [`LearningRate`](super::LearningRate), it is not divided by
/// their number.
impl StepSize for f64 {
    #[inline]
    fn uniform(&self) -> Option<f64> {
        Some(*self)
    }

    #[inline]
    fn at(&self, _weight: usize) -> f64 {
        *self
    }
}

/// A scheduled step size, the same for each active row: unlike [`LearningRate`](super::LearningRate), it is not divided by
/// their number.
impl StepSize for Schedule {
    #[inline]
    fn uniform(&self) -> Option<f64> {
        Some(self.value())
    }

    #[inline]
    fn at(&self, _weight: usize) -> f64 {
        self.value()
    }

    #[inline]
    fn end_episode(&mut self) {
        Schedule::end_episode(self);
    }
}
