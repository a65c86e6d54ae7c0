//! The observations of all sub-environments, batched as Gymnasium batches them.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::convert::{array_of, rows_array, small_array};

/// A type of observations that Python receives in batches.
pub(crate) trait BatchObservation: Copy + Send + 'static {
    /// The observations in new arrays.
    fn batched<'py>(py: Python<'py>, all: &[Self]) -> PyResult<Bound<'py, PyAny>>;

    /// Writes the observations into arrays made by `batched`.
    fn write(all: &[Self], out: &Bound<'_, PyAny>) -> PyResult<()>;

    /// One observation, as a single environment returns it.
    fn single<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>>;
}

/// A float32 array of shape `(num_envs, N)`.
impl<const N: usize> BatchObservation for [f32; N] {
    fn batched<'py>(py: Python<'py>, all: &[Self]) -> PyResult<Bound<'py, PyAny>> {
        Ok(rows_array(py, all)?.into_any())
    }

    fn write(all: &[Self], out: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut out = out.cast::<PyArray2<f32>>()?.try_readwrite()?;
        let out = out.as_slice_mut()?;
        // Python code also has the array, and may have resized it.
        if out.len() != all.len() * N {
            return Err(PyValueError::new_err(format!("the array of observations must keep its {} rows", all.len())));
        }
        out.copy_from_slice(all.as_flattened());
        Ok(())
    }

    fn single<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(small_array(py, self).into_any())
    }
}

/// An int64 array of shape `(num_envs,)`.
impl BatchObservation for u32 {
    fn batched<'py>(py: Python<'py>, all: &[Self]) -> PyResult<Bound<'py, PyAny>> {
        Ok(array_of(py, all.iter().map(|&number| i64::from(number)))?.into_any())
    }

    fn write(all: &[Self], out: &Bound<'_, PyAny>) -> PyResult<()> {
        write_column(out, all.iter().copied())
    }

    fn single<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.into_pyobject(py)?.into_any())
    }
}

/// A tuple of `N` int64 arrays of shape `(num_envs,)`.
impl<const N: usize> BatchObservation for [u32; N] {
    fn batched<'py>(py: Python<'py>, all: &[Self]) -> PyResult<Bound<'py, PyAny>> {
        let column = |index: usize| array_of(py, all.iter().map(|numbers| i64::from(numbers[index])));
        Ok(PyTuple::new(py, (0..N).map(column).collect::<PyResult<Vec<_>>>()?)?.into_any())
    }

    fn write(all: &[Self], out: &Bound<'_, PyAny>) -> PyResult<()> {
        (0..N).try_for_each(|index| write_column(&out.get_item(index)?, all.iter().map(|numbers| numbers[index])))
    }

    fn single<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(PyTuple::new(py, self)?.into_any())
    }
}

fn write_column(out: &Bound<'_, PyAny>, numbers: impl Iterator<Item = u32>) -> PyResult<()> {
    let mut out = out.cast::<PyArray1<i64>>()?.try_readwrite()?;
    out.as_slice_mut()?.iter_mut().zip(numbers).for_each(|(item, number)| *item = number.into());
    Ok(())
}
