//! Observations that a policy in Python can read.

use pyo3::prelude::*;

use crate::convert::{array_from, small_array};

/// An observation that a policy in Python can read.
pub(crate) trait PyObservation {
    fn to_python<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>>;
}

impl<const M: usize> PyObservation for [f32; M] {
    fn to_python<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(small_array(py, self).into_any())
    }
}

impl<T: numpy::Element + Copy> PyObservation for Vec<T> {
    fn to_python<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(array_from(py, self)?.into_any())
    }
}

impl PyObservation for Py<PyAny> {
    fn to_python<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.bind(py).clone())
    }
}
