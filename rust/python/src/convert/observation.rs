//! Conversion of a Python environment's observations to the active rows of the table.

use std::marker::PhantomData;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::Features;
use qtab_core::features::{ActiveRows, OutOfBounds};
use qtab_core::numeric::Float;

use crate::error::RunError;

/// Observations of at most this many components are read without an allocation.
const FEW_COMPONENTS: usize = 32;

/// Reads the observations of one observation space.
pub(crate) trait ObservationReader {
    type Active: ActiveRows;

    /// The active rows of an observation.
    fn active_rows(&self, observation: &Bound<'_, PyAny>) -> Result<Self::Active, RunError>;
}

/// Reads the observations of a Box of dtype `T` and shape `(dimensions,)`.
pub(crate) struct BoxReader<T, F> {
    features: F,
    dimensions: usize,
    dtype: PhantomData<T>,
}

impl<T, F> BoxReader<T, F> {
    pub(crate) fn new(features: F, dimensions: usize) -> Self {
        Self { features, dimensions, dtype: PhantomData }
    }

    fn wrong_shape(&self, observation: &Bound<'_, PyAny>) -> PyErr {
        match observation.getattr(intern!(observation.py(), "shape")) {
            Ok(shape) => PyValueError::new_err(format!(
                "an observation must have shape ({},), the space's, got {shape}",
                self.dimensions
            )),
            Err(error) => error,
        }
    }
}

impl<T: Float + Default + numpy::Element, F> BoxReader<T, F> {
    /// Calls a function with the features and the numbers of an observation.
    pub(crate) fn read<R>(
        &self,
        observation: &Bound<'_, PyAny>,
        read: impl FnOnce(&F, &[T]) -> Result<R, OutOfBounds>,
    ) -> Result<R, RunError> {
        let py = observation.py();
        let converted;
        let array = if let Ok(array) = observation.cast::<PyArray1<T>>() {
            array
        } else {
            // The dtype differs from the space's: convert to the dtype that the space declares.
            let arguments = (observation, numpy::dtype::<T>(py));
            let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "asarray"), arguments)?;
            converted = array.cast_into::<PyArray1<T>>().map_err(|error| self.wrong_shape(&error.into_inner()))?;
            &converted
        };
        if array.len()? != self.dimensions {
            return Err(self.wrong_shape(array).into());
        }
        // Item by item, without the numpy crate's record of borrowed arrays, which takes longer than the rest of a
        // step.
        let item = |index| array.get_owned(index).unwrap_or_default();
        let mut few = [T::default(); FEW_COMPONENTS];
        if let Some(values) = few.get_mut(..self.dimensions) {
            values.iter_mut().enumerate().for_each(|(index, value)| *value = item(index));
            return Ok(read(&self.features, values)?);
        }
        Ok(read(&self.features, &(0..self.dimensions).map(item).collect::<Vec<_>>())?)
    }
}

impl<T: Float + Default + numpy::Element, F: Features<[T]>> ObservationReader for BoxReader<T, F> {
    type Active = F::Active;

    fn active_rows(&self, observation: &Bound<'_, PyAny>) -> Result<F::Active, RunError> {
        self.read(observation, Features::active_rows)
    }
}

/// Reads observations of a Discrete space, or of several together: each combination of integers has its own row.
#[derive(Clone, Debug)]
pub(crate) struct DiscreteReader {
    /// The first integer of each component, and the number of integers.
    axes: Vec<(i64, u32)>,
    /// Whether an observation is a single integer, not a sequence of integers.
    scalar: bool,
}

impl DiscreteReader {
    pub(crate) fn new(axes: Vec<(i64, u32)>, scalar: bool) -> Self {
        Self { axes, scalar }
    }

    pub(crate) fn n_rows(&self) -> usize {
        self.axes.iter().map(|&(_, count)| count as usize).product()
    }

    pub(crate) fn counts(&self) -> impl Iterator<Item = u32> + '_ {
        self.axes.iter().map(|&(_, count)| count)
    }

    pub(crate) fn dimensions(&self) -> usize {
        self.axes.len()
    }

    pub(crate) fn is_scalar(&self) -> bool {
        self.scalar
    }

    /// The row of an observation with as many components as the space.
    pub(crate) fn row(&self, observation: &[i64]) -> Result<u32, OutOfBounds> {
        observation.iter().enumerate().try_fold(0, |row, (axis, &number)| self.extend(row, axis, number))
    }

    /// The row after one more component.
    fn extend(&self, row: u32, axis: usize, number: i64) -> Result<u32, OutOfBounds> {
        let (first, count) = self.axes[axis];
        match number.checked_sub(first).and_then(|offset| u32::try_from(offset).ok()) {
            Some(offset) if offset < count => Ok(row * count + offset),
            _ => Err(OutOfBounds { axis, value: number as f64 }),
        }
    }

    fn wrong_type(&self, observation: &Bound<'_, PyAny>) -> PyErr {
        let expected = if self.scalar {
            "be an integer, as the space's are".into()
        } else {
            format!("hold {} integers, as the space's do", self.axes.len())
        };
        let got = observation.repr().map_or_else(|_| "an object without a repr".into(), |text| text.to_string());
        PyValueError::new_err(format!("an observation must {expected}, got {got}"))
    }
}

impl ObservationReader for DiscreteReader {
    type Active = [u32; 1];

    fn active_rows(&self, observation: &Bound<'_, PyAny>) -> Result<[u32; 1], RunError> {
        if self.scalar {
            let number = observation.extract().map_err(|_| self.wrong_type(observation))?;
            return Ok([self.extend(0, 0, number)?]);
        }
        let (mut row, mut count) = (0, 0);
        for number in observation.try_iter().map_err(|_| self.wrong_type(observation))? {
            let number = number?.extract().map_err(|_| self.wrong_type(observation))?;
            if count == self.axes.len() {
                return Err(self.wrong_type(observation).into());
            }
            row = self.extend(row, count, number)?;
            count += 1;
        }
        if count < self.axes.len() {
            return Err(self.wrong_type(observation).into());
        }
        Ok([row])
    }
}
