//! The errors of the binding: what can end a run early, and how an argument is refused.

use std::fmt::Display;

use pyo3::PyErr;
use pyo3::exceptions::{PyOverflowError, PyValueError};
use qtab_core::features::OutOfBounds;

/// Why a run ended before its last episode.
pub(crate) enum RunError {
    /// An observation outside the observation space.
    OutOfBounds(OutOfBounds),
    /// An exception that Python code raised, such as a Python environment's.
    Python(PyErr),
    /// The action values overflowed in this episode, counted from 0.
    Diverged { episode: usize },
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

impl From<RunError> for PyErr {
    fn from(error: RunError) -> Self {
        match error {
            RunError::OutOfBounds(error) => PyValueError::new_err(error.to_string()),
            RunError::Python(error) => error,
            RunError::Diverged { episode } => PyOverflowError::new_err(format!(
                "the action values overflowed in episode {episode} (counted from 0): the updates grow instead of \
                 settling; most likely learning_rate is too large, or trace_decay or discount with these traces"
            )),
        }
    }
}

/// A `ValueError` that names the argument, what would fit, and what was given.
pub(crate) fn invalid(name: &str, expected: impl Display, got: impl Display) -> PyErr {
    PyValueError::new_err(format!("{name} must be {expected}, got {got}"))
}

/// A `ValueError` for a missing argument.
pub(crate) fn required(name: &str) -> PyErr {
    PyValueError::new_err(format!("{name} must be given"))
}
