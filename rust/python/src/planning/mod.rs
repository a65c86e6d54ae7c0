//! Optimal policies: dynamic programming on a transition table, and searches over the dynamics of classic control.

mod expected_updates;
mod grid_search;
mod mdp_solver;

use pyo3::exceptions::{PyKeyboardInterrupt, PyOverflowError, PyValueError};
use pyo3::prelude::*;
use qtab_core::planning::PlanningError;

use crate::error::out_of_memory;

pub(crate) use expected_updates::PyExpectedUpdates;
pub(crate) use grid_search::PyGridSearch;
pub(crate) use mdp_solver::PyMdpSolver;

/// The error for an optimal policy that could not be found.
fn to_py_err(error: PlanningError, discount: f64) -> PyErr {
    of_any_method(error).unwrap_or_else(|| {
        PyValueError::new_err(format!(
            "discount must be smaller, got {discount}: {error}; method 'finite_horizon' works with any discount"
        ))
    })
}

/// The error for a policy that could not be evaluated.
fn of_policy(error: PlanningError, discount: f64) -> PyErr {
    of_any_method(error).unwrap_or_else(|| {
        PyValueError::new_err(match error {
            _ if discount < 1.0 => format!("discount must be smaller, got {discount}: {error}"),
            PlanningError::NoProperPolicy(_) => {
                format!("policy must end every episode: {error}; with a discount below 1 it has values anyway")
            }
            _ => format!("policy must end episodes in fewer steps: {error}; a discount below 1 helps"),
        })
    })
}

/// The errors that all methods share.
fn of_any_method(error: PlanningError) -> Option<PyErr> {
    match error {
        PlanningError::Stopped => Some(PyKeyboardInterrupt::new_err(())),
        PlanningError::OutOfMemory { bytes } => Some(out_of_memory(bytes)),
        PlanningError::Overflow(_) => Some(PyOverflowError::new_err(format!("rewards must be smaller: {error}"))),
        PlanningError::NotConverged { .. } | PlanningError::NoProperPolicy(_) | PlanningError::UnboundedReturn(_) => {
            None
        }
    }
}
