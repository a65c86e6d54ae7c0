//! Optimal policies: dynamic programming on a transition table, and the search over `MountainCar`'s dynamics.

mod expected_updates;
mod mdp_solver;
mod mountain_car_search;

use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use qtab_core::planning::PlanningError;

use crate::error::out_of_memory;

pub(crate) use expected_updates::PyExpectedUpdates;
pub(crate) use mdp_solver::PyMdpSolver;
pub(crate) use mountain_car_search::PyMountainCarSearch;

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
