//! Why training ended before its budget was used up.

use crate::memory::AllocationError;

/// Why training ended before its budget was used up. `E` is the task's error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TrainingError<E> {
    /// The task failed.
    Task(E),
    /// What the run stores does not fit into memory.
    Allocation(AllocationError),
}

impl<E> From<AllocationError> for TrainingError<E> {
    fn from(error: AllocationError) -> Self {
        Self::Allocation(error)
    }
}
