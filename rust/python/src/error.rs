//! The errors of the bindings: early ends of runs, and invalid arguments.

use std::fmt::Display;

use pyo3::exceptions::{PyKeyboardInterrupt, PyMemoryError, PyOverflowError, PyRuntimeError, PyValueError};
use pyo3::{PyErr, create_exception};
use qtab_core::TrainingError;
use qtab_core::checkpoint::CheckpointError;
use qtab_core::features::OutOfBounds;
use qtab_core::memory::{AllocationError, Growing};

create_exception!(
    qtab._core,
    CompiledCodeError,
    PyRuntimeError,
    "A call of a vector environment that fails in compiled code, but not in Python, which has to take over."
);

/// Why a run ended before its last episode.
pub(crate) enum RunError {
    /// An observation outside the observation space.
    OutOfBounds(OutOfBounds),
    /// An exception that Python code raised, such as a Python environment's.
    Python(PyErr),
    /// The run's data does not fit into memory, or its construction was stopped.
    Allocation(AllocationError),
    /// The action values overflowed in this episode, counted from 0, of a run whose features are `weighted` or not.
    Diverged { episode: usize, weighted: bool },
    /// The action values have overflowed at the end of the run, whose last episode this was, counted from 0.
    Overflowed { episode: usize },
}

impl From<OutOfBounds> for RunError {
    fn from(error: OutOfBounds) -> Self {
        Self::OutOfBounds(error)
    }
}

impl From<PyErr> for RunError {
    fn from(error: PyErr) -> Self {
        Self::Python(error)
    }
}

impl From<AllocationError> for RunError {
    fn from(error: AllocationError) -> Self {
        Self::Allocation(error)
    }
}

impl RunError {
    /// The error of a run whose features are `weighted` or not.
    pub(crate) fn of_training<E: Into<Self>>(error: TrainingError<E>, weighted: bool) -> Self {
        match error {
            TrainingError::Task(error) => error.into(),
            TrainingError::Allocation(error) => error.into(),
            TrainingError::Diverged { episode } => Self::Diverged { episode, weighted },
        }
    }
}

/// The errors of runs with binary features, and of tasks that record, which do not diverge.
impl<E> From<TrainingError<E>> for RunError
where
    RunError: From<E>,
{
    fn from(error: TrainingError<E>) -> Self {
        Self::of_training(error, false)
    }
}

impl From<RunError> for PyErr {
    fn from(error: RunError) -> Self {
        match error {
            RunError::OutOfBounds(error) => PyValueError::new_err(error.to_string()),
            RunError::Python(error) => error,
            RunError::Allocation(AllocationError::Stopped) => PyKeyboardInterrupt::new_err(()),
            RunError::Allocation(AllocationError::OutOfMemory { bytes }) => out_of_memory(bytes),
            RunError::Allocation(AllocationError::LimitReached { limit, growing }) => limit_reached(limit, growing),
            RunError::Allocation(AllocationError::TooManyEntries) => PyMemoryError::new_err(
                "this algorithm supports fewer than 2**32 state-action pairs and fewer than 2**31 outcomes of its \
                 model, but this run needs more; use a table with fewer cells, or train for fewer episodes",
            ),
            RunError::Diverged { episode, weighted } => {
                let cause = if weighted {
                    ": try a tenth of it, and of value_learning_rate, or a smaller trace_decay, if the algorithm has them"
                } else {
                    ", or trace_decay or discount with these traces"
                };
                PyOverflowError::new_err(format!(
                    "the action values overflowed in episode {episode} (counted from 0): the updates grow instead of \
                     settling; most likely learning_rate is too large{cause}"
                ))
            }
            RunError::Overflowed { episode } => PyOverflowError::new_err(format!(
                "the action values overflowed by episode {episode} (counted from 0); most likely the rewards, initial_q \
                 or learning_rate are too large"
            )),
        }
    }
}

/// A `MemoryError`: this many more bytes could not be allocated.
pub(crate) fn out_of_memory(bytes: usize) -> PyErr {
    let size = readable(bytes as u64);
    PyMemoryError::new_err(format!("out of memory: another {size} could not be allocated"))
}

/// A `MemoryError`: the data that grows during a run would exceed the user's limit.
fn limit_reached(limit: u64, growing: Growing) -> PyErr {
    let (what, instead) = match growing {
        Growing::Recordings => ("the recordings", "record fewer episodes with record="),
        Growing::Learner => (
            "what the algorithm stores during the run (the steps of an episode, or the outcomes of its model)",
            "shorten the episodes with max_episode_steps=",
        ),
    };
    let size = readable(limit);
    PyMemoryError::new_err(format!(
        "{what} would exceed memory_limit={limit} ({size}); {instead}, or increase memory_limit"
    ))
}

fn readable(bytes: u64) -> String {
    match bytes {
        0..1024 => format!("{bytes} bytes"),
        1024..1_048_576 => format!("{} KiB", bytes >> 10),
        1_048_576..1_073_741_824 => format!("{} MiB", bytes >> 20),
        _ => format!("{} GiB", bytes >> 30),
    }
}

/// Converts a failed allocation to a Python exception.
pub(crate) fn allocation(error: AllocationError) -> PyErr {
    RunError::from(error).into()
}

/// The error for a checkpoint that cannot be written or read; `owner` names the object that it belongs to.
pub(crate) fn unusable_checkpoint(error: CheckpointError, owner: &str) -> PyErr {
    match error {
        CheckpointError::OutOfMemory => PyMemoryError::new_err(format!("the checkpoint cannot be made: {error}")),
        _ => PyValueError::new_err(format!("the checkpoint does not fit the {owner}: {error}")),
    }
}

/// A `ValueError` that names the argument, the expected value and the given one.
pub(crate) fn invalid(name: &str, expected: impl Display, got: impl Display) -> PyErr {
    PyValueError::new_err(format!("{name} must be {expected}, got {got}"))
}

/// A `ValueError` for a missing argument.
pub(crate) fn required(name: &str) -> PyErr {
    PyValueError::new_err(format!("{name} must be given"))
}
