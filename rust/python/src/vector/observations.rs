//! Observations of all sub-environments, as Gymnasium batches them.

use numpy::ndarray::aview2;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// An observation as a type of the core's.
pub(super) trait Shows: Copy + Send + 'static {
    /// In new arrays.
    fn batched<'py>(py: Python<'py>, all: &[Self]) -> PyResult<Bound<'py, PyAny>>;

    /// Puts them into arrays that were new once.
    fn put(all: &[Self], places: &Bound<'_, PyAny>) -> PyResult<()>;

    /// One, as a lone environment returns it.
    fn alone<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>>;
}

/// (count, N) float32
impl<const N: usize> Shows for [f32; N] {
    fn batched<'py>(py: Python<'py>, all: &[Self]) -> PyResult<Bound<'py, PyAny>> {
        Ok(PyArray2::from_array(py, &aview2(all)).into_any())
    }

    fn put(all: &[Self], places: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut places = places.cast::<PyArray2<f32>>()?.try_readwrite()?;
        let places = places.as_slice_mut()?;
        // Whoever was handed the array may have given it another size.
        if places.len() != all.len() * N {
            return Err(PyValueError::new_err(format!("the array of observations must keep its {} rows", all.len())));
        }
        places.copy_from_slice(all.as_flattened());
        Ok(())
    }

    fn alone<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(PyArray1::from_slice(py, self).into_any())
    }
}

/// (count,) int64
impl Shows for u32 {
    fn batched<'py>(py: Python<'py>, all: &[Self]) -> PyResult<Bound<'py, PyAny>> {
        Ok(PyArray1::from_iter(py, all.iter().map(|&number| i64::from(number))).into_any())
    }

    fn put(all: &[Self], places: &Bound<'_, PyAny>) -> PyResult<()> {
        column(places, all.iter().copied())
    }

    fn alone<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.into_pyobject(py)?.into_any())
    }
}

/// `N` of (count,) int64
impl<const N: usize> Shows for [u32; N] {
    fn batched<'py>(py: Python<'py>, all: &[Self]) -> PyResult<Bound<'py, PyAny>> {
        let column = |index: usize| PyArray1::from_iter(py, all.iter().map(|numbers| i64::from(numbers[index])));
        Ok(PyTuple::new(py, (0..N).map(column).collect::<Vec<_>>())?.into_any())
    }

    fn put(all: &[Self], places: &Bound<'_, PyAny>) -> PyResult<()> {
        (0..N).try_for_each(|index| column(&places.get_item(index)?, all.iter().map(|numbers| numbers[index])))
    }

    fn alone<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(PyTuple::new(py, self)?.into_any())
    }
}

fn column(places: &Bound<'_, PyAny>, numbers: impl Iterator<Item = u32>) -> PyResult<()> {
    let mut places = places.cast::<PyArray1<i64>>()?.try_readwrite()?;
    places.as_slice_mut()?.iter_mut().zip(numbers).for_each(|(place, number)| *place = number.into());
    Ok(())
}
