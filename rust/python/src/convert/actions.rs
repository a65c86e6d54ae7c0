//! Single actions, as Gymnasium's `step` takes them.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyInt, PyType};
use qtab_core::numeric::Scalar;

/// `math.pow` raises where the square of a larger force would overflow.
pub(crate) const LARGEST_FORCE: f64 = 1e150;

/// A discrete action: a Python or `NumPy` integer from 0 to `count` - 1; None for anything else.
pub(crate) fn discrete_action(action: &Bound<'_, PyAny>, count: usize) -> Option<usize> {
    numbered_action(action, 0, count)
}

/// The number, from 0, of a discrete action: a Python or `NumPy` integer from `first` to `first + count - 1`; None for
/// anything else.
pub(crate) fn numbered_action(action: &Bound<'_, PyAny>, first: i64, count: usize) -> Option<usize> {
    static INTEGER: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let py = action.py();
    if !action.is_instance_of::<PyInt>() && !action.is_instance(INTEGER.import(py, "numpy", "integer").ok()?).ok()? {
        return None;
    }
    let number = action.extract::<i64>().ok()?.checked_sub(first)?;
    usize::try_from(number).ok().filter(|&number| number < count)
}

/// The first number of a continuous action, in the dtype of its array; None if it is too large or not in a float array.
pub(crate) fn box_action(action: &Bound<'_, PyAny>) -> Option<Scalar> {
    first_item(action).filter(|&force| f64::from(force).abs() <= LARGEST_FORCE)
}

/// The first item of a float array, in its dtype.
pub(crate) fn first_item(array: &Bound<'_, PyAny>) -> Option<Scalar> {
    if let Ok(array) = array.cast::<PyArray1<f32>>() {
        return array.get_owned(0).map(Scalar::Single);
    }
    array.cast::<PyArray1<f64>>().ok()?.get_owned(0).map(Scalar::Double)
}
