//! Optimal policies: dynamic programming on a transition table, and searches over the dynamics of classic control.

mod expected_updates;
mod grid_search;
mod mdp_solver;

use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use qtab_core::planning::PlanningError;

use crate::error::out_of_memory;

pub(crate) use expected_updates::PyExpectedUpdates;
pub(crate) use grid_search::PyGridSearch;
pub(crate) use mdp_solver::PyMdpSolver;

fn to_py_err(error: PlanningError, discount: f64) -> PyErr {
    if error == PlanningError::Stopped {
        return PyKeyboardInterrupt::new_err(());
    }
    if let PlanningError::OutOfMemory { bytes } = error {
        return out_of_memory(bytes);
    }
    PyValueError::new_err(format!(
        "discount must be smaller here, got {discount}: {error}; method 'finite_horizon' fits any discount"
    ))
}
