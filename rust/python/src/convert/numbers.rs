//! Conversions of Python and `NumPy` numbers; None for numbers with which Python would compute a different result.

use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt};
use qtab_core::numeric::Scalar;

use super::small_array;

/// `NumPy` warns about constants too large for f32, and Python raises if the square is too large for f64.
const LARGEST_FLOAT: f64 = 1e30;
/// Python computes exactly with integers of any size; f64 does so only up to the products of integers of this size.
const LARGEST_INTEGER: f64 = 1e6;

/// A constant of an environment. It must be a plain Python number, since `NumPy` numbers promote differently.
pub(crate) fn constant(value: &Bound<'_, PyAny>) -> Option<f64> {
    if value.is_exact_instance_of::<PyFloat>() {
        let number: f64 = value.extract().ok()?;
        return (number.abs() <= LARGEST_FLOAT || number.is_infinite()).then_some(number);
    }
    if value.is_exact_instance_of::<PyInt>() {
        let number: f64 = value.extract().ok()?;
        return (number.abs() <= LARGEST_INTEGER).then_some(number);
    }
    None
}

/// A number that becomes f64 in any array: a Python float, an `np.float64` (which is a Python float), a small integer.
pub(crate) fn double(value: &Bound<'_, PyAny>) -> Option<f64> {
    if value.is_instance_of::<PyFloat>() {
        return value.extract().ok();
    }
    constant(value)
}

/// A `NumPy` scalar. Taking an array's item is faster than calling the scalar's type.
pub(crate) fn numpy_scalar(py: Python<'_>, number: Scalar) -> PyResult<Bound<'_, PyAny>> {
    match number {
        Scalar::Single(number) => small_array(py, &[number]).get_item(0),
        Scalar::Python(number) | Scalar::Double(number) => small_array(py, &[number]).get_item(0),
    }
}
