//! The trait of the features of states.

use crate::memory::{AllocationError, RunMemory};

/// The active rows of states, which are numbered: by the task, or in the order of the visits.
pub trait RowSets {
    /// The active rows of a state.
    fn of(&self, state: u32) -> &[u32];

    /// The row of a state that has one active row; the first one otherwise.
    #[inline]
    fn first(&self, state: u32) -> usize {
        self.of(state)[0] as usize
    }

    /// The number of active rows of a state.
    fn n_active(&self) -> usize;

    /// The number of weights.
    fn n_weights(&self) -> usize;

    /// The number of the first state of an episode, whose rows the task gives.
    fn begin(&mut self, active: &[u32]) -> u32;

    /// The number of the state that was visited last.
    fn current(&self, active: &[u32]) -> u32;

    /// The number of the state that follows it.
    fn visit_next(&mut self, active: &[u32]) -> u32;

    /// Makes room for so many more states.
    ///
    /// # Errors
    /// `OutOfMemory`, `LimitReached`.
    fn reserve(&mut self, _states: u64, _memory: &mut RunMemory) -> Result<(), AllocationError> {
        Ok(())
    }
}
