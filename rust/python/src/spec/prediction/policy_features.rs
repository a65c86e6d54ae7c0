//! The features of a Box by which a greedy policy chooses its actions.

use pyo3::prelude::*;
use qtab_core::Features;
use qtab_core::features::{AnyBasis, OutOfBounds};
use qtab_core::numeric::Float;

use super::action_values::ActionValues;
use super::box_features::BoxFeatures;
use crate::convert::BoxReader;
use crate::error::RunError;
use crate::spec::DiscretizerSpec;

/// Binary or weighted features of observations of dtype `T`.
pub(crate) enum PolicyFeatures<T> {
    Binary(BoxFeatures<T>),
    Weighted(AnyBasis<T>),
}

impl<T: Float> PolicyFeatures<T> {
    pub(crate) fn new(spec: &DiscretizerSpec, to_dtype: impl Fn(f64) -> T) -> PyResult<Self> {
        Ok(match spec.weighted() {
            Some(weighted) => Self::Weighted(weighted.basis()?),
            None => Self::Binary(BoxFeatures::new(spec, to_dtype)?),
        })
    }

    fn read_numbers(&self, observation: &[T], values: &mut ActionValues) -> Result<(), OutOfBounds> {
        match self {
            Self::Binary(features) => values.add_rows(features.active_rows(observation)?.as_ref()),
            Self::Weighted(basis) => {
                basis.write_active_rows(observation, &mut values.features)?;
                values.add_products();
            }
        }
        Ok(())
    }
}

/// Finds the action values of observations of type `O`.
pub(crate) trait ReadValues<O> {
    fn read_values(&self, observation: &O, values: &mut ActionValues) -> Result<(), RunError>;
}

impl<const M: usize> ReadValues<[f32; M]> for PolicyFeatures<f32> {
    fn read_values(&self, observation: &[f32; M], values: &mut ActionValues) -> Result<(), RunError> {
        Ok(self.read_numbers(observation, values)?)
    }
}

impl<T: Float> ReadValues<Vec<T>> for PolicyFeatures<T> {
    fn read_values(&self, observation: &Vec<T>, values: &mut ActionValues) -> Result<(), RunError> {
        Ok(self.read_numbers(observation, values)?)
    }
}

impl<T: Float + Default + numpy::Element> ReadValues<Py<PyAny>> for BoxReader<T, PolicyFeatures<T>> {
    fn read_values(&self, observation: &Py<PyAny>, values: &mut ActionValues) -> Result<(), RunError> {
        Python::attach(|py| self.read(observation.bind(py), |features, numbers| features.read_numbers(numbers, values)))
    }
}
