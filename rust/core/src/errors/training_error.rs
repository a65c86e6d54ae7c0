//! Why training ended before its budget was used up.

use std::error::Error;
use std::fmt;

use crate::memory::AllocationError;

/// Why training ended before its budget was used up. `E` is the task's error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TrainingError<E> {
    /// The task failed.
    Task(E),
    /// What the run stores does not fit into memory.
    Allocation(AllocationError),
    /// The action values have overflowed. They are useless, and further training would be too.
    Diverged {
        /// The unfinished episode, or the last finished one, counted from 0.
        episode: usize,
    },
}

impl<E> From<AllocationError> for TrainingError<E> {
    fn from(error: AllocationError) -> Self {
        Self::Allocation(error)
    }
}

impl<E: fmt::Display> fmt::Display for TrainingError<E> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Task(error) => write!(formatter, "the task failed: {error}"),
            Self::Allocation(error) => write!(formatter, "the run does not fit into memory: {error}"),
            Self::Diverged { episode } => write!(
                formatter,
                "the action values overflowed in episode {episode} (counted from 0): the updates grow instead of \
                 settling. Train again with a smaller learning rate. With tile coding, a step size that is a plain f64 \
                 or a Schedule must be divided by the number of tilings; LearningRate divides by itself"
            ),
        }
    }
}

impl<E: Error + 'static> Error for TrainingError<E> {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Task(error) => Some(error),
            Self::Allocation(error) => Some(error),
            Self::Diverged { .. } => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_has_a_message_and_a_source() {
        let allocation = AllocationError::TooManyEntries;
        let error = TrainingError::<AllocationError>::from(allocation);
        assert!(error.source().is_some_and(|source| source.to_string() == allocation.to_string()));
        let diverged = TrainingError::<AllocationError>::Diverged { episode: 8 };
        assert!(diverged.to_string().contains("episode 8"), "{diverged}");
        assert!(diverged.source().is_none());
    }
}
