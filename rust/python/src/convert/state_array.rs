//! The state of a classic-control environment, as Python code may have assigned it.

use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use qtab_core::numeric::Scalar;

use super::double;

/// A state of up to four finite numbers, and the dtype in which Python would compute with it.
#[derive(Clone, Copy)]
pub(crate) struct StateArray {
    numbers: [f64; 4],
    dtype: Dtype,
}

#[derive(Clone, Copy, PartialEq)]
enum Dtype {
    F32,
    F64,
    /// A tuple of Python floats or `NumPy` doubles.
    PythonTuple,
}

impl StateArray {
    /// An f64 state left by a step in Rust, padded with zeros.
    pub(crate) fn new(numbers: [f64; 4]) -> Self {
        Self { numbers, dtype: Dtype::F64 }
    }

    /// The `count` numbers of an array or a tuple; None for any other state.
    pub(crate) fn read(value: &Bound<'_, PyAny>, count: usize) -> Option<Self> {
        let mut numbers = [0.0; 4];
        let dtype = if let Ok(array) = value.cast::<PyArray1<f64>>() {
            for (index, number) in numbers.iter_mut().take(count).enumerate() {
                *number = array.get_owned(index)?;
            }
            (array.len() == count).then_some(Dtype::F64)
        } else if let Ok(array) = value.cast::<PyArray1<f32>>() {
            for (index, number) in numbers.iter_mut().take(count).enumerate() {
                *number = array.get_owned(index)?.into();
            }
            (array.len() == count).then_some(Dtype::F32)
        } else {
            let tuple = value.cast::<PyTuple>().ok()?;
            for (number, item) in numbers.iter_mut().zip(tuple.iter()) {
                *number = double(&item)?;
            }
            (tuple.len() == count).then_some(Dtype::PythonTuple)
        }?;
        numbers.iter().all(|number| number.is_finite()).then_some(Self { numbers, dtype })
    }

    /// The numbers, if Python would compute with them in f64.
    pub(crate) fn doubles<const N: usize>(&self) -> Option<[f64; N]> {
        (self.dtype != Dtype::F32).then(|| self.numbers())
    }

    /// The numbers of an f64 array; None for a tuple, whose numbers may promote differently.
    pub(crate) fn double_array<const N: usize>(&self) -> Option<[f64; N]> {
        (self.dtype == Dtype::F64).then(|| self.numbers())
    }

    /// The numbers of an array, in its dtype.
    pub(crate) fn scalars<const N: usize>(&self) -> Option<[Scalar; N]> {
        match self.dtype {
            Dtype::F32 => Some(self.numbers::<N>().map(|number| Scalar::Single(number as f32))),
            Dtype::F64 => Some(self.numbers().map(Scalar::Double)),
            Dtype::PythonTuple => None,
        }
    }

    /// The numbers in f64, whatever their dtype: f32 converts exactly.
    pub(crate) fn numbers<const N: usize>(&self) -> [f64; N] {
        std::array::from_fn(|index| self.numbers[index])
    }
}
