//! What can end a run early, and its one conversion to a Python exception.

use pyo3::PyErr;
use pyo3::exceptions::{PyOverflowError, PyValueError};
use qtab_core::features::OutOfBounds;

pub(crate) enum Failure {
    OutOfBounds(OutOfBounds),
    Python(PyErr),
    /// The values overflowed in this episode.
    Diverged(usize),
}

impl From<OutOfBounds> for Failure {
    fn from(outside: OutOfBounds) -> Self {
        Self::OutOfBounds(outside)
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Self {
        Self::Python(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::OutOfBounds(outside) => PyValueError::new_err(outside.to_string()),
            Failure::Python(error) => error,
            Failure::Diverged(episode) => PyOverflowError::new_err(format!(
                "the action values overflowed in episode {episode} (counted from 0): the updates grow instead of \
                 settling; most likely learning_rate is too large, or trace_decay or discount with these traces"
            )),
        }
    }
}
