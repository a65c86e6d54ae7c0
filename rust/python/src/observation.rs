//! From an observation in Python to the rows that it lights.

use std::marker::PhantomData;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::Features;
use qtab_core::features::OutOfBounds;
use qtab_core::numeric::Float;

use crate::failure::Failure;

/// What reads the observations of a space.
pub(crate) trait Reader {
    type Rows: Copy + AsRef<[u32]>;

    fn rows(&self, observation: &Bound<'_, PyAny>) -> Result<Self::Rows, Failure>;
}

/// A box of dtype `T` whose numbers light rows by `F`.
pub(crate) struct Floats<T, F> {
    features: F,
    dimensions: usize,
    dtype: PhantomData<T>,
}

impl<T, F> Floats<T, F> {
    pub(crate) fn new(features: F, dimensions: usize) -> Self {
        Self { features, dimensions, dtype: PhantomData }
    }

    fn misshapen(&self, observation: &Bound<'_, PyAny>) -> PyErr {
        match observation.getattr(intern!(observation.py(), "shape")) {
            Ok(shape) => PyValueError::new_err(format!(
                "an observation must have shape ({},), the space's, got {shape}",
                self.dimensions
            )),
            Err(error) => error,
        }
    }
}

impl<T: Float + numpy::Element, F: Features<[T]>> Reader for Floats<T, F> {
    type Rows = F::Active;

    fn rows(&self, observation: &Bound<'_, PyAny>) -> Result<F::Active, Failure> {
        let py = observation.py();
        let converted;
        let array = if let Ok(array) = observation.cast::<PyArray1<T>>() {
            array
        } else {
            // Not the space's dtype: read as the space says that it is meant.
            let arguments = (observation, numpy::dtype::<T>(py));
            let array = py.import(intern!(py, "numpy"))?.call_method1(intern!(py, "asarray"), arguments)?;
            converted = array.cast_into::<PyArray1<T>>().map_err(|error| self.misshapen(&error.into_inner()))?;
            &converted
        };
        if array.len()? != self.dimensions {
            return Err(self.misshapen(array).into());
        }
        let values = array.readonly();
        match values.as_slice() {
            Ok(values) => Ok(self.features.active_rows(values)?),
            Err(_) => Ok(self.features.active_rows(&values.as_array().to_vec())?),
        }
    }
}

/// Whole numbers, each combination a row: a Discrete space, or several in a row.
pub(crate) struct Integers {
    /// The first number of each component and how many there are.
    pub(crate) axes: Vec<(i64, u32)>,
    /// Whether the observation is one number, not a row of one.
    pub(crate) scalar: bool,
}

impl Integers {
    fn unfit(&self, observation: &Bound<'_, PyAny>) -> PyErr {
        let wanted = if self.scalar {
            "be an integer, as the space's are".into()
        } else {
            format!("hold {} integers, as the space's do", self.axes.len())
        };
        let got = observation.repr().map_or_else(|_| "another".into(), |text| text.to_string());
        PyValueError::new_err(format!("an observation must {wanted}, got {got}"))
    }

    /// The row with one more component.
    fn extend(&self, row: u32, axis: usize, number: i64) -> Result<u32, OutOfBounds> {
        let (first, count) = self.axes[axis];
        match number.checked_sub(first).and_then(|offset| u32::try_from(offset).ok()) {
            Some(offset) if offset < count => Ok(row * count + offset),
            _ => Err(OutOfBounds { axis, value: number as f64 }),
        }
    }
}

impl Reader for Integers {
    type Rows = [u32; 1];

    fn rows(&self, observation: &Bound<'_, PyAny>) -> Result<[u32; 1], Failure> {
        if self.scalar {
            let number = observation.extract().map_err(|_| self.unfit(observation))?;
            return Ok([self.extend(0, 0, number)?]);
        }
        let (mut row, mut count) = (0, 0);
        for number in observation.try_iter().map_err(|_| self.unfit(observation))? {
            let number = number?.extract().map_err(|_| self.unfit(observation))?;
            if count == self.axes.len() {
                return Err(self.unfit(observation).into());
            }
            row = self.extend(row, count, number)?;
            count += 1;
        }
        if count < self.axes.len() {
            return Err(self.unfit(observation).into());
        }
        Ok([row])
    }
}
