//! The spec of the Fourier basis.

use pyo3::prelude::*;
use qtab_core::features::{FourierBasis, MAX_FEATURES};
use qtab_core::numeric::Float;

use super::discretizer::{FloatType, same_length};
use super::fields::Fields;
use crate::error::invalid;

/// The Fourier basis, which gives each row of the table a number.
#[derive(Clone, Debug)]
pub(crate) struct FourierSpec {
    pub(super) dtype: FloatType,
    low: Vec<f64>,
    high: Vec<f64>,
    order: u32,
    coupled: bool,
    scale_step_sizes: bool,
    len: usize,
}

impl FourierSpec {
    pub(super) fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        let mut spec = Self {
            dtype: FloatType::parse(fields)?,
            low: fields.get("low")?,
            high: fields.get("high")?,
            order: fields.get("order")?,
            coupled: fields.get("coupled")?,
            scale_step_sizes: fields.get("scale_step_sizes")?,
            len: 0,
        };
        same_length(fields, "high", spec.high.len(), spec.low.len())?;
        spec.len = spec.basis::<f64, MAX_FEATURES>()?.n_features();
        Ok(spec)
    }

    /// The number of components of an observation.
    pub(super) fn dimensions(&self) -> usize {
        self.low.len()
    }

    /// The number of features.
    pub(crate) fn n_features(&self) -> usize {
        self.len
    }

    /// The features, with room for `M` of them, which must be enough.
    pub(crate) fn basis<T: Float, const M: usize>(&self) -> PyResult<FourierBasis<T, M>> {
        FourierBasis::try_new(&self.low, &self.high, self.order, self.coupled, self.scale_step_sizes)
            .map_err(|error| invalid("discretizer", "a Fourier basis", error))
    }

    /// The number that divides the step size of each row; empty if all are the same.
    pub(crate) fn step_size_divisors(&self) -> PyResult<Vec<f64>> {
        Ok(self.basis::<f64, MAX_FEATURES>()?.divisors())
    }
}

/// Evaluates an expression in which the constant `$m` is a capacity for at least `$len` features, at most
/// [`MAX_FEATURES`].
macro_rules! match_capacity {
    ($len:expr, $m:ident => $compiled:expr) => {
        match $len {
            0..=64 => {
                const $m: usize = 64;
                $compiled
            }
            _ => {
                const $m: usize = qtab_core::features::MAX_FEATURES;
                $compiled
            }
        }
    };
}

pub(crate) use match_capacity;
