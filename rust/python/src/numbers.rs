//! Python's and `NumPy`'s numbers as the physics take them; None for those whose arithmetic would be another.

use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyFloat, PyInt, PyTuple, PyType};
use qtab_core::numeric::Scalar;

/// `NumPy` warns where a constant is too large for f32, Python raises where its square is too large for f64.
const LARGEST_FLOAT: f64 = 1e30;
/// Python computes exactly with integers of any size.
const LARGEST_INTEGER: f64 = 1e6;
/// `math.pow` raises where the square of a force is too large.
pub(crate) const LARGEST_FORCE: f64 = 1e150;

/// A constant of the physics: a plain Python number, not one of `NumPy`'s, which promotes otherwise.
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

/// A number that ends up in an array of f64 whatever it is: a Python float, an `np.float64` (which is one), an integer.
pub(crate) fn double(value: &Bound<'_, PyAny>) -> Option<f64> {
    if value.is_instance_of::<PyFloat>() {
        return value.extract().ok();
    }
    constant(value)
}

/// A state of up to four finite numbers.
#[derive(Clone, Copy)]
pub(crate) struct Values {
    numbers: [f64; 4],
    dtype: Dtype,
}

#[derive(Clone, Copy, PartialEq)]
enum Dtype {
    Single,
    Double,
    /// A tuple of Python's or `NumPy`'s doubles.
    Loose,
}

impl Values {
    /// The numbers that a step left in Rust.
    pub(crate) fn new(numbers: [f64; 4]) -> Self {
        Self { numbers, dtype: Dtype::Double }
    }

    /// The `count` numbers of an array or a tuple.
    pub(crate) fn read(value: &Bound<'_, PyAny>, count: usize) -> Option<Self> {
        let mut numbers = [0.0; 4];
        let dtype = if let Ok(array) = value.cast::<PyArray1<f64>>() {
            for (index, number) in numbers.iter_mut().take(count).enumerate() {
                *number = array.get_owned(index)?;
            }
            (array.len() == count).then_some(Dtype::Double)
        } else if let Ok(array) = value.cast::<PyArray1<f32>>() {
            for (index, number) in numbers.iter_mut().take(count).enumerate() {
                *number = array.get_owned(index)?.into();
            }
            (array.len() == count).then_some(Dtype::Single)
        } else {
            let tuple = value.cast::<PyTuple>().ok()?;
            for (number, item) in numbers.iter_mut().zip(tuple.iter()) {
                *number = double(&item)?;
            }
            (tuple.len() == count).then_some(Dtype::Loose)
        }?;
        numbers.iter().all(|number| number.is_finite()).then_some(Self { numbers, dtype })
    }

    /// As f64, where the state computes as f64.
    pub(crate) fn doubles<const N: usize>(&self) -> Option<[f64; N]> {
        (self.dtype != Dtype::Single).then(|| self.numbers())
    }

    /// As f64 where they come from an array of f64: a tuple's numbers may promote otherwise.
    pub(crate) fn double_array<const N: usize>(&self) -> Option<[f64; N]> {
        (self.dtype == Dtype::Double).then(|| self.numbers())
    }

    /// In the dtype of the array that they come from.
    pub(crate) fn scalars<const N: usize>(&self) -> Option<[Scalar; N]> {
        match self.dtype {
            Dtype::Single => Some(self.numbers::<N>().map(|number| Scalar::Single(number as f32))),
            Dtype::Double => Some(self.numbers().map(Scalar::Double)),
            Dtype::Loose => None,
        }
    }

    /// As they are: an f32 is an f64, too.
    pub(crate) fn numbers<const N: usize>(&self) -> [f64; N] {
        std::array::from_fn(|index| self.numbers[index])
    }
}

/// The first number of a continuous action, in the dtype of its array.
pub(crate) fn force(action: &Bound<'_, PyAny>) -> Option<Scalar> {
    first(action).filter(|&force| f64::from(force).abs() <= LARGEST_FORCE)
}

/// The same, however large.
pub(crate) fn first(array: &Bound<'_, PyAny>) -> Option<Scalar> {
    if let Ok(array) = array.cast::<PyArray1<f32>>() {
        return array.get_owned(0).map(Scalar::Single);
    }
    array.cast::<PyArray1<f64>>().ok()?.get_owned(0).map(Scalar::Double)
}

/// A number as `NumPy` wraps it; an array's item comes sooner than a call of the type.
pub(crate) fn numpy_scalar(py: Python<'_>, number: Scalar) -> PyResult<Bound<'_, PyAny>> {
    match number {
        Scalar::Single(number) => PyArray1::from_slice(py, &[number]).get_item(0),
        Scalar::Python(number) | Scalar::Double(number) => PyArray1::from_slice(py, &[number]).get_item(0),
    }
}

/// A discrete action, where it is an integer of Python's or `NumPy`'s from 0 on and below `count`.
pub(crate) fn index(action: &Bound<'_, PyAny>, count: usize) -> Option<usize> {
    static INTEGER: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let py = action.py();
    if !action.is_instance_of::<PyInt>() && !action.is_instance(INTEGER.import(py, "numpy", "integer").ok()?).ok()? {
        return None;
    }
    action.extract::<usize>().ok().filter(|&index| index < count)
}
