//! Features of the observations that an environment writes into a buffer.

use std::marker::PhantomData;

use qtab_core::Features;
use qtab_core::features::{OutOfBounds, Product};
use qtab_env::Number;

use crate::convert::DiscreteReader;

/// A number of an observation that can be converted to the dtype of a discretizer, as `NumPy`'s `astype` does.
pub(super) trait ConvertTo<T>: Number {
    fn convert(self) -> T;
}

macro_rules! convert_to {
    ($($from:ty => $to:ty),*) => {$(
        impl ConvertTo<$to> for $from {
            #[inline]
            fn convert(self) -> $to {
                self as $to
            }
        }
    )*};
}

convert_to!(f32 => f64, f64 => f32, i64 => f32, i64 => f64);

impl ConvertTo<f64> for f64 {
    #[inline]
    fn convert(self) -> f64 {
        self
    }
}

/// Features of numbers of type `T`, for observations of another type.
#[derive(Clone, Debug)]
pub(super) struct Converted<T, F> {
    pub(super) features: F,
    to: PhantomData<T>,
}

impl<T, F> Converted<T, F> {
    pub(super) fn new(features: F) -> Self {
        Self { features, to: PhantomData }
    }
}

impl<S: ConvertTo<T>, T, F: Features<[T]>> Features<[S]> for Converted<T, F> {
    type Active = F::Active;

    fn active_rows(&self, observation: &[S]) -> Result<F::Active, OutOfBounds> {
        self.features.active_rows(&observation.iter().map(|&number| number.convert()).collect::<Vec<T>>())
    }

    fn len(&self) -> usize {
        self.features.len()
    }
}

/// The features of a product, for observations of any type.
pub(super) type ConvertedProduct = Converted<f64, Product>;

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
