//! Arrays of any numeric dtype, converted as `NumPy`'s `astype` does.

use std::sync::Arc;

use numpy::ndarray::{Dimension, aview2};
use numpy::{
    PyArray1, PyArray2, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArray, PyReadonlyArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyTypeError;
use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::memory::collect;
use qtab_core::numeric::Float;

use crate::error::allocation;

/// A dtype of a Box, to which any number converts as with `astype`.
pub(crate) trait FromNumber: Float + numpy::Element {
    fn from_f64(number: f64) -> Self;
    fn from_i64(number: i64) -> Self;
    fn from_u64(number: u64) -> Self;
}

impl FromNumber for f32 {
    fn from_f64(number: f64) -> Self {
        number as Self
    }

    fn from_i64(number: i64) -> Self {
        number as Self
    }

    fn from_u64(number: u64) -> Self {
        number as Self
    }
}

impl FromNumber for f64 {
    fn from_f64(number: f64) -> Self {
        number
    }

    fn from_i64(number: i64) -> Self {
        number as Self
    }

    fn from_u64(number: u64) -> Self {
        number as Self
    }
}

/// The numbers of an array in C order. `as_slice` would return them in memory order, which may be Fortran's.
pub(crate) fn in_c_order<T: numpy::Element + Copy, D: Dimension>(
    array: &PyReadonlyArray<'_, T, D>,
) -> PyResult<Arc<[T]>> {
    collect(array.as_array().iter().copied()).map(Arc::from).map_err(allocation)
}

/// A new array of a few numbers. It panics if memory runs out, but then the interpreter could not continue either.
#[inline]
#[expect(clippy::disallowed_methods, reason = "a few numbers")]
pub(crate) fn small_array<'py, T: numpy::Element + Copy, const N: usize>(
    py: Python<'py>,
    values: &[T; N],
) -> Bound<'py, PyArray1<T>> {
    PyArray1::from_slice(py, values)
}

/// Up to this many bytes, `NumPy` allocates the array, which is several times faster. It panics if memory runs out, but
/// then the interpreter could not continue either.
const SMALL: usize = 1 << 14;

/// A new array with a copy of these values. `PyArray1::from_slice` would panic if memory runs out.
#[inline]
#[expect(clippy::disallowed_methods, reason = "a small array")]
pub(crate) fn array_from<'py, T: numpy::Element + Copy>(
    py: Python<'py>,
    values: &[T],
) -> PyResult<Bound<'py, PyArray1<T>>> {
    if size_of_val(values) <= SMALL {
        return Ok(PyArray1::from_slice(py, values));
    }
    array_of(py, values.iter().copied())
}

/// A new array of shape `(rows.len(), N)` with a copy of these rows.
#[inline]
#[expect(clippy::disallowed_methods, reason = "a small array")]
pub(crate) fn rows_array<'py, T: numpy::Element + Copy, const N: usize>(
    py: Python<'py>,
    rows: &[[T; N]],
) -> PyResult<Bound<'py, PyArray2<T>>> {
    if size_of_val(rows) <= SMALL {
        return Ok(PyArray2::from_array(py, &aview2(rows)));
    }
    array_of(py, rows.as_flattened().iter().copied())?.reshape([rows.len(), N])
}

/// A new array of these values. `PyArray1::from_iter` would panic if memory runs out.
pub(crate) fn array_of<T: numpy::Element + Copy>(
    py: Python<'_>,
    values: impl ExactSizeIterator<Item = T>,
) -> PyResult<Bound<'_, PyArray1<T>>> {
    Ok(PyArray1::from_vec(py, collect(values).map_err(allocation)?))
}

/// The numbers of an array in C order, in the dtype `T`.
pub(crate) fn floats<T: FromNumber>(array: &Bound<'_, PyUntypedArray>) -> PyResult<Vec<T>> {
    match array.dtype().kind() {
        b'f' => {
            if let Ok(values) = array.extract::<PyReadonlyArrayDyn<'_, T>>() {
                return collect(values.as_array().iter().copied()).map_err(allocation);
            }
            converted(array, "float64", T::from_f64)
        }
        b'i' => converted(array, "int64", T::from_i64),
        b'u' => converted(array, "uint64", T::from_u64),
        _ => Err(PyTypeError::new_err(format!("observation must hold numbers, got {}", array.repr()?))),
    }
}

/// The integers of an array in C order.
pub(crate) fn integers(array: &Bound<'_, PyUntypedArray>) -> PyResult<Vec<i64>> {
    match array.dtype().kind() {
        b'i' | b'b' => converted(array, "int64", |number: i64| number),
        // No space has integers beyond i64, and no space contains the largest i64.
        b'u' => converted(array, "uint64", |number: u64| i64::try_from(number).unwrap_or(i64::MAX)),
        _ => Err(PyTypeError::new_err(format!("observation must hold integers, got {}", array.repr()?))),
    }
}

fn converted<S, T>(array: &Bound<'_, PyUntypedArray>, dtype: &str, convert: impl Fn(S) -> T) -> PyResult<Vec<T>>
where
    S: numpy::Element + Copy,
{
    let array = array.call_method1(intern!(array.py(), "astype"), (dtype,))?;
    let values: PyReadonlyArrayDyn<'_, S> = array.extract()?;
    collect(values.as_array().iter().map(|&value| convert(value))).map_err(allocation)
}
