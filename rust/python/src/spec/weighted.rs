//! The specs of weighted features.

use pyo3::prelude::*;
use qtab_core::features::{AnyBasis, CoarseCoding, FourierBasis, MAX_FEATURES, PolynomialBasis, RadialBasis};
use qtab_core::numeric::Float;

use super::discretizer::{FloatType, same_length};
use super::fields::Fields;
use crate::error::invalid;

/// Weighted features, which give each row of the table a number.
#[derive(Clone, Debug)]
pub(crate) struct WeightedSpec {
    pub(super) dtype: FloatType,
    low: Vec<f64>,
    high: Vec<f64>,
    kind: Kind,
    len: usize,
}

/// A kind of weighted features, with its options.
#[derive(Clone, Debug)]
enum Kind {
    Fourier { order: u32, coupled: bool, scale_step_sizes: bool },
    Polynomial { order: u32, coupled: bool },
    Radial { centers: Vec<u32>, width: Vec<f64>, normalized: bool },
    Coarse { centers: Vec<u32>, radius: Vec<f64> },
}

impl WeightedSpec {
    pub(super) fn fourier(fields: &Fields<'_>) -> PyResult<Self> {
        let (order, coupled) = (fields.get("order")?, fields.get("coupled")?);
        Self::parse(fields, Kind::Fourier { order, coupled, scale_step_sizes: fields.get("scale_step_sizes")? })
    }

    pub(super) fn polynomial(fields: &Fields<'_>) -> PyResult<Self> {
        Self::parse(fields, Kind::Polynomial { order: fields.get("order")?, coupled: fields.get("coupled")? })
    }

    pub(super) fn radial(fields: &Fields<'_>) -> PyResult<Self> {
        let (centers, width) = (fields.get("centers")?, fields.get("width")?);
        Self::parse(fields, Kind::Radial { centers, width, normalized: fields.get("normalized")? })
    }

    pub(super) fn coarse(fields: &Fields<'_>) -> PyResult<Self> {
        Self::parse(fields, Kind::Coarse { centers: fields.get("centers")?, radius: fields.get("radius")? })
    }

    fn parse(fields: &Fields<'_>, kind: Kind) -> PyResult<Self> {
        let (low, high): (Vec<f64>, Vec<f64>) = (fields.get("low")?, fields.get("high")?);
        same_length(fields, "high", high.len(), low.len())?;
        let mut spec = Self { dtype: FloatType::parse(fields)?, low, high, kind, len: 0 };
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
    pub(crate) fn basis<T: Float, const M: usize>(&self) -> PyResult<AnyBasis<T, M>> {
        let (low, high) = (&self.low[..], &self.high[..]);
        let basis = match &self.kind {
            Kind::Fourier { order, coupled, scale_step_sizes } => {
                FourierBasis::try_new(low, high, *order, *coupled, *scale_step_sizes).map(AnyBasis::Fourier)
            }
            Kind::Polynomial { order, coupled } => {
                PolynomialBasis::try_new(low, high, *order, *coupled).map(AnyBasis::Polynomial)
            }
            Kind::Radial { centers, width, normalized } => {
                RadialBasis::try_new(low, high, centers, width, *normalized).map(AnyBasis::Radial)
            }
            Kind::Coarse { centers, radius } => CoarseCoding::try_new(low, high, centers, radius).map(AnyBasis::Coarse),
        };
        basis.map_err(|error| invalid("discretizer", "weighted features with valid options", error))
    }

    /// The number that divides the step size of each row; empty if all are the same.
    pub(crate) fn step_size_divisors(&self) -> PyResult<Vec<f64>> {
        Ok(self.basis::<f64, MAX_FEATURES>()?.divisors())
    }
}

/// Evaluates an expression in which the constant `$m` is a capacity for at least `$len` features: 64 or [`MAX_FEATURES`]. A
/// third would make the extension several percent larger.
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
