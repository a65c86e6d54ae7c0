//! Features of the observations that an environment writes into a buffer.

use pyo3::prelude::*;
use qtab_core::Features;
use qtab_core::features::OutOfBounds;
use qtab_env::host::Episode;
use qtab_env::{FLOAT32, FLOAT64, Number};

use super::external_env::SharedEnv;
use crate::convert::{DiscreteReader, array_from};

/// A number of an observation that can be converted to the dtype of a discretizer, as `NumPy`'s `astype` does.
pub(super) trait ConvertTo<T>: Number {
    /// The number less `first`.
    fn convert(self, first: T) -> T;
}

macro_rules! convert_to {
    ($($from:ty => $to:ty),*) => {$(
        impl ConvertTo<$to> for $from {
            #[inline]
            fn convert(self, first: $to) -> $to {
                self as $to - first
            }
        }
    )*};
}

convert_to!(f32 => f64, f64 => f32, i64 => f32, i64 => f64);

impl ConvertTo<f64> for f64 {
    #[inline]
    fn convert(self, first: f64) -> f64 {
        self - first
    }
}

impl ConvertTo<i64> for i64 {
    #[inline]
    fn convert(self, first: i64) -> i64 {
        self.wrapping_sub(first)
    }
}

/// The last observation of an episode, as an array of its dtype.
pub(super) fn observation_array<'py>(py: Python<'py>, episode: &Episode<SharedEnv>) -> PyResult<Bound<'py, PyAny>> {
    Ok(match episode.environment().observation_type() {
        FLOAT32 => array_from(py, episode.observation::<f32>())?.into_any(),
        FLOAT64 => array_from(py, episode.observation::<f64>())?.into_any(),
        _ => array_from(py, episode.observation::<i64>())?.into_any(),
    })
}

/// Observations of at most this many numbers are converted without an allocation.
const FEW_NUMBERS: usize = 32;

/// Features of numbers of type `T`, for observations of another type, or for indices that do not begin at 0.
#[derive(Clone, Debug)]
pub(super) struct Converted<T, F> {
    features: F,
    /// The numbers to subtract from those of an observation; empty for zeros.
    first: Vec<T>,
}

impl<T, F> Converted<T, F> {
    pub(super) fn new(features: F, first: Vec<T>) -> Self {
        Self { features, first }
    }
}

impl<S, T, F> Features<[S]> for Converted<T, F>
where
    S: ConvertTo<T>,
    T: Copy + Default,
    F: Features<[T]>,
{
    type Active = F::Active;

    fn active_rows(&self, observation: &[S]) -> Result<F::Active, OutOfBounds> {
        let first = |index| self.first.get(index).copied().unwrap_or_default();
        let converted = observation.iter().enumerate().map(|(index, &number)| number.convert(first(index)));
        let mut few = [T::default(); FEW_NUMBERS];
        if let Some(values) = few.get_mut(..observation.len()) {
            values.iter_mut().zip(converted).for_each(|(value, number)| *value = number);
            return self.features.active_rows(values);
        }
        self.features.active_rows(&converted.collect::<Vec<T>>())
    }

    fn len(&self) -> usize {
        self.features.len()
    }
}

/// Each combination of integers has its own row.
impl Features<[i64]> for DiscreteReader {
    type Active = [u32; 1];

    fn active_rows(&self, observation: &[i64]) -> Result<[u32; 1], OutOfBounds> {
        Ok([self.row(observation)?])
    }

    fn len(&self) -> usize {
        self.n_rows()
    }
}
