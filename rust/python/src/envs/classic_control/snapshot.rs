//! The states of sub-environments as Gymnasium's classes keep them.

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::convert::{array_from, small_array};

/// Writes the attribute `state`, an array of float64.
pub(super) fn set_state<const N: usize>(attributes: &Bound<'_, PyDict>, state: impl Into<[f64; N]>) -> PyResult<()> {
    let py = attributes.py();
    attributes.set_item(intern!(py, "state"), small_array(py, &state.into()))
}

/// Writes the attribute `state`, an array of float32.
pub(super) fn set_f32_state(attributes: &Bound<'_, PyDict>, state: &[f32]) -> PyResult<()> {
    let py = attributes.py();
    attributes.set_item(intern!(py, "state"), array_from(py, state)?)
}
