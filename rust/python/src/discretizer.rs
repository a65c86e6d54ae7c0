//! `Discretizer`: the active rows of one or many observations, computed with the features that training uses.

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::features::{ActiveFeatures, Features, MAX_FEATURES, MAX_TILINGS, OutOfBounds};
use qtab_core::memory::with_capacity;
use qtab_core::numeric::Float;

use crate::convert::{DiscreteReader, FromNumber, floats, integers};
use crate::error::allocation;
use crate::spec::{DiscretizerSpec, Fields, FloatType};

/// Maps observations to the active rows of a table, as its `DiscretizerSpec` describes.
#[pyclass(frozen, name = "Discretizer", module = "qtab._core")]
pub(crate) struct PyDiscretizer {
    features: AnyFeatures,
    /// The number of components of an observation; None for a single integer.
    dimensions: Option<usize>,
    n_active: usize,
    /// Whether the features are weighted.
    weighted: bool,
}

enum AnyFeatures {
    F32(Box<dyn DynFeatures<f32>>),
    F64(Box<dyn DynFeatures<f64>>),
    Discrete(DiscreteReader),
}

#[pymethods]
impl PyDiscretizer {
    #[new]
    fn new(spec: &Bound<'_, PyAny>) -> PyResult<Self> {
        let spec = DiscretizerSpec::parse(&Fields::new(spec)?)?;
        let (n_active, weighted) = (spec.n_active(), spec.weighted().is_some());
        if let DiscretizerSpec::Identity(reader) = spec {
            let dimensions = (!reader.is_scalar()).then(|| reader.dimensions());
            return Ok(Self { features: AnyFeatures::Discrete(reader), dimensions, n_active, weighted });
        }
        let (dtype, dimensions) = spec.box_space()?;
        let features = match dtype {
            FloatType::F32 => AnyFeatures::F32(dyn_features(&spec, |bound| bound as f32)?),
            FloatType::F64 => match spec {
                DiscretizerSpec::Product(product) => AnyFeatures::F64(Box::new(product.features)),
                spec => AnyFeatures::F64(dyn_features(&spec, |bound| bound)?),
            },
        };
        Ok(Self { features, dimensions: Some(dimensions), n_active, weighted })
    }

    /// The number of rows of the table.
    #[getter]
    fn n_rows(&self) -> usize {
        match &self.features {
            AnyFeatures::F32(features) => features.n_rows(),
            AnyFeatures::F64(features) => features.n_rows(),
            AnyFeatures::Discrete(reader) => reader.n_rows(),
        }
    }

    /// The number of rows that are active at a time.
    #[getter]
    fn n_active(&self) -> usize {
        self.n_active
    }

    /// The active rows as int64: shape `(n_active,)` for one observation, `(n, n_active)` for a batch of `n`
    /// observations.
    fn active_rows<'py>(&self, observations: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
        let py = observations.py();
        let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "asarray"), (observations,))?;
        let array = array.cast_into::<PyUntypedArray>()?;
        let batch = self.batch_size(&array)?;
        let rows = match &self.features {
            AnyFeatures::F32(features) => {
                self.of_floats(&array, batch, |one: &[f32], rows| features.append_active_rows(one, rows))?
            }
            AnyFeatures::F64(features) => {
                self.of_floats(&array, batch, |one: &[f64], rows| features.append_active_rows(one, rows))?
            }
            AnyFeatures::Discrete(reader) => self.rows_of_integers(reader, &array, batch)?,
        };
        self.in_shape(py, rows, batch)
    }

    /// The values of weighted features: shape `(n_rows,)` for one observation, `(n, n_rows)` for a batch of `n`
    /// observations.
    fn feature_values<'py>(&self, observations: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        if !self.weighted {
            return Err(PyValueError::new_err("feature_values needs weighted features, such as those of 'fourier'"));
        }
        let py = observations.py();
        let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "asarray"), (observations,))?;
        let array = array.cast_into::<PyUntypedArray>()?;
        let batch = self.batch_size(&array)?;
        let values = match &self.features {
            AnyFeatures::F32(features) => {
                self.of_floats(&array, batch, |one: &[f32], values| features.append_values(one, values))?
            }
            AnyFeatures::F64(features) => {
                self.of_floats(&array, batch, |one: &[f64], values| features.append_values(one, values))?
            }
            AnyFeatures::Discrete(_) => Vec::new(),
        };
        self.in_shape(py, values, batch)
    }
}

impl PyDiscretizer {
    /// The numbers of one observation, or of a batch, as an array.
    fn in_shape<'py, N: numpy::Element>(
        &self,
        py: Python<'py>,
        numbers: Vec<N>,
        batch: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<N>>> {
        let numbers = PyArray1::from_vec(py, numbers);
        match batch {
            Some(count) => numbers.reshape([count, self.n_active].as_slice()),
            None => numbers.reshape([self.n_active].as_slice()),
        }
    }

    /// The number of observations in an array; None for a single observation that is not in a batch.
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

    fn of_floats<T: FromNumber, N>(
        &self,
        array: &Bound<'_, PyUntypedArray>,
        batch: Option<usize>,
        append: impl Fn(&[T], &mut Vec<N>) -> Result<(), OutOfBounds>,
    ) -> PyResult<Vec<N>> {
        self.of_each(&floats::<T>(array)?, batch, append)
    }

    fn rows_of_integers(
        &self,
        reader: &DiscreteReader,
        array: &Bound<'_, PyUntypedArray>,
        batch: Option<usize>,
    ) -> PyResult<Vec<i64>> {
        let values = integers(array)?;
        self.of_each(&values, batch, |observation, rows| {
            rows.push(reader.row(observation)?.into());
            Ok(())
        })
    }

    /// The active rows, or their features, of all observations, one observation after another.
    fn of_each<T, N>(
        &self,
        values: &[T],
        batch: Option<usize>,
        append: impl Fn(&[T], &mut Vec<N>) -> Result<(), OutOfBounds>,
    ) -> PyResult<Vec<N>> {
        let dimensions = self.dimensions.unwrap_or(1);
        let count = batch.unwrap_or(1);
        let mut rows = with_capacity(count.saturating_mul(self.n_active)).map_err(allocation)?;
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

    fn append_values(&self, observation: &[T], values: &mut Vec<f64>) -> Result<(), OutOfBounds>;
}

impl<T, F: Features<[T]> + Send + Sync> DynFeatures<T> for F {
    fn n_rows(&self) -> usize {
        self.len()
    }

    fn append_active_rows(&self, observation: &[T], rows: &mut Vec<i64>) -> Result<(), OutOfBounds> {
        rows.extend(self.active_rows(observation)?.as_ref().iter().map(|&row| i64::from(row)));
        Ok(())
    }

    fn append_values(&self, observation: &[T], values: &mut Vec<f64>) -> Result<(), OutOfBounds> {
        values.extend_from_slice(self.active_rows(observation)?.values());
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
    if let DiscretizerSpec::Weighted(features) = spec {
        return Ok(Box::new(features.basis::<T, MAX_FEATURES>()?));
    }
    Ok(Box::new(spec.grid(to_dtype)?))
}
