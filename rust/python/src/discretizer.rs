//! `Discretizer`: the active rows of observations, one or many at once, by the features that training uses.

use numpy::{
    PyArray1, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::features::{Features, MAX_TILINGS, OutOfBounds};
use qtab_core::numeric::Float;

use crate::convert::DiscreteReader;
use crate::spec::{DiscretizerSpec, Fields, FloatType};

/// Maps observations to the active rows of a table, as a `DiscretizerSpec` describes.
#[pyclass(frozen, name = "Discretizer", module = "qtab._core")]
pub(crate) struct PyDiscretizer {
    features: AnyFeatures,
    /// How many components an observation has; None for a single integer.
    dimensions: Option<usize>,
    n_active: usize,
}

enum AnyFeatures {
    F32(Box<dyn DynFeatures<f32>>),
    F64(Box<dyn DynFeatures<f64>>),
    Integers(DiscreteReader),
}

#[pymethods]
impl PyDiscretizer {
    #[new]
    fn new(spec: &Bound<'_, PyAny>) -> PyResult<Self> {
        let spec = DiscretizerSpec::parse(&Fields::new(spec)?)?;
        let n_active = if let DiscretizerSpec::Tiles(tiles) = &spec { tiles.tilings as usize } else { 1 };
        let (features, dimensions) = match (spec.box_space(), &spec) {
            (Some((FloatType::F32, dimensions)), _) => {
                (AnyFeatures::F32(dyn_features(&spec, |bound| bound as f32)?), Some(dimensions))
            }
            (Some((FloatType::F64, dimensions)), _) => {
                (AnyFeatures::F64(dyn_features(&spec, |bound| bound)?), Some(dimensions))
            }
            (None, DiscretizerSpec::Identity(reader)) => {
                (AnyFeatures::Integers(reader.clone()), (!reader.is_scalar()).then(|| reader.dimensions()))
            }
            (None, _) => return Err(PyTypeError::new_err("spec must describe a discretizer")),
        };
        Ok(Self { features, dimensions, n_active })
    }

    /// How many rows the table has.
    #[getter]
    fn n_rows(&self) -> usize {
        match &self.features {
            AnyFeatures::F32(features) => features.n_rows(),
            AnyFeatures::F64(features) => features.n_rows(),
            AnyFeatures::Integers(reader) => reader.n_rows(),
        }
    }

    /// How many rows are active at a time.
    #[getter]
    fn n_active(&self) -> usize {
        self.n_active
    }

    /// The active rows of one observation, an int64 array of shape `(n_active,)`; of a batch of `n` observations, one of
    /// shape `(n, n_active)`.
    fn active_rows<'py>(&self, observations: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        let py = observations.py();
        let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "asarray"), (observations,))?;
        let array = array.cast_into::<PyUntypedArray>()?;
        let batch = self.batch_size(&array)?;
        let rows = match &self.features {
            AnyFeatures::F32(features) => self.rows_of_floats(&**features, &array, batch)?,
            AnyFeatures::F64(features) => self.rows_of_floats(&**features, &array, batch)?,
            AnyFeatures::Integers(reader) => self.rows_of_integers(reader, &array, batch)?,
        };
        let rows = PyArray1::from_vec(py, rows);
        match batch {
            Some(count) => rows.reshape([count, self.n_active].as_slice()),
            None => rows.reshape([self.n_active].as_slice()),
        }
    }
}

impl PyDiscretizer {
    /// How many observations an array holds; None for one observation that is not in a batch.
    fn batch_size(&self, array: &Bound<'_, PyUntypedArray>) -> PyResult<Option<usize>> {
        let (shape, components) = (array.shape(), self.dimensions.as_slice());
        if shape == components {
            return Ok(None);
        }
        if let Some((&count, rest)) = shape.split_first()
            && rest == components
        {
            return Ok(Some(count));
        }
        let got = array.getattr(intern!(array.py(), "shape"))?;
        Err(PyValueError::new_err(match self.dimensions {
            Some(count) if shape.len() < 2 => format!("observation must have shape ({count},), got {got}"),
            Some(count) => format!("observations must have shape (n, {count}), got {got}"),
            None => format!("observations must have shape () or (n,), got {got}"),
        }))
    }

    fn rows_of_floats<T: FromNumber>(
        &self,
        features: &dyn DynFeatures<T>,
        array: &Bound<'_, PyUntypedArray>,
        batch: Option<usize>,
    ) -> PyResult<Vec<i64>> {
        let values = floats::<T>(array)?;
        self.rows(&values, batch, |observation, rows| features.append_active_rows(observation, rows))
    }

    fn rows_of_integers(
        &self,
        reader: &DiscreteReader,
        array: &Bound<'_, PyUntypedArray>,
        batch: Option<usize>,
    ) -> PyResult<Vec<i64>> {
        let values = integers(array)?;
        self.rows(&values, batch, |observation, rows| {
            rows.push(reader.row(observation)?.into());
            Ok(())
        })
    }

    /// The rows of each observation in turn.
    fn rows<T>(
        &self,
        values: &[T],
        batch: Option<usize>,
        append: impl Fn(&[T], &mut Vec<i64>) -> Result<(), OutOfBounds>,
    ) -> PyResult<Vec<i64>> {
        let dimensions = self.dimensions.unwrap_or(1);
        let count = batch.unwrap_or(1);
        let mut rows = Vec::with_capacity(count * self.n_active);
        for index in 0..count {
            append(&values[index * dimensions..][..dimensions], &mut rows).map_err(|error| {
                PyValueError::new_err(match batch {
                    None => error.to_string(),
                    Some(_) => error.to_string().replacen("observation", &format!("observations[{index}]"), 1),
                })
            })?;
        }
        Ok(rows)
    }
}

/// Features over observations of dtype `T`.
trait DynFeatures<T>: Send + Sync {
    fn n_rows(&self) -> usize;

    fn append_active_rows(&self, observation: &[T], rows: &mut Vec<i64>) -> Result<(), OutOfBounds>;
}

impl<T, F: Features<[T]> + Send + Sync> DynFeatures<T> for F {
    fn n_rows(&self) -> usize {
        self.len()
    }

    fn append_active_rows(&self, observation: &[T], rows: &mut Vec<i64>) -> Result<(), OutOfBounds> {
        rows.extend(self.active_rows(observation)?.as_ref().iter().map(|&row| i64::from(row)));
        Ok(())
    }
}

fn dyn_features<T: Float + 'static>(
    spec: &DiscretizerSpec,
    to_dtype: impl Fn(f64) -> T,
) -> PyResult<Box<dyn DynFeatures<T>>> {
    if let DiscretizerSpec::Tiles(tiles) = spec {
        return Ok(Box::new(tiles.tile_coding::<T, MAX_TILINGS>()));
    }
    match spec.grid(to_dtype) {
        Some(grid) => Ok(Box::new(grid)),
        None => Err(PyTypeError::new_err("spec must describe a discretizer of a Box")),
    }
}

/// A dtype of a Box, to which any number converts as `astype` converts it.
trait FromNumber: Float + numpy::Element {
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

/// The numbers of an array in C order, in the dtype `T`.
fn floats<T: FromNumber>(array: &Bound<'_, PyUntypedArray>) -> PyResult<Vec<T>> {
    match array.dtype().kind() {
        b'f' => {
            if let Ok(values) = array.extract::<PyReadonlyArrayDyn<'_, T>>() {
                return Ok(values.as_array().iter().copied().collect());
            }
            converted(array, "float64", T::from_f64)
        }
        b'i' => converted(array, "int64", T::from_i64),
        b'u' => converted(array, "uint64", T::from_u64),
        _ => Err(PyTypeError::new_err(format!("observation must hold numbers, got {}", array.repr()?))),
    }
}

/// The integers of an array in C order.
fn integers(array: &Bound<'_, PyUntypedArray>) -> PyResult<Vec<i64>> {
    match array.dtype().kind() {
        b'i' | b'b' => converted(array, "int64", |number: i64| number),
        // No space has integers beyond i64, and none contains its largest.
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
    Ok(values.as_array().iter().map(|&value| convert(value)).collect())
}
