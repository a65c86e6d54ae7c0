//! Observations scaled to the unit cube.

use super::super::checked_tilings::check_bounds;
use crate::errors::BuildError;
use crate::features::OutOfBounds;
use crate::numeric::Float;

/// The bounds of a box, which is scaled to [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ScaledBox {
    bounds: Vec<(f64, f64)>,
}

impl ScaledBox {
    pub(super) fn try_new(low: &[f64], high: &[f64]) -> Result<Self, BuildError> {
        let expected = format_args!("of the length of low, {}", low.len());
        BuildError::check(high.len() == low.len(), "high", expected, high.len())?;
        BuildError::check(!low.is_empty(), "low", "the bounds of at least one component", "none")?;
        let bounds: Vec<_> = low.iter().copied().zip(high.iter().copied()).collect();
        check_bounds(bounds.iter().copied())?;
        for (component, (low, high)) in bounds.iter().enumerate() {
            let got = format_args!("{high:?} above {low:?} for component {component}");
            BuildError::check((high - low).is_finite(), "high", "a finite distance above low", got)?;
        }
        Ok(Self { bounds })
    }

    pub(super) fn dimensions(&self) -> usize {
        self.bounds.len()
    }

    /// (value - low) / (high - low), clipped to the bounds before.
    #[inline]
    pub(super) fn scale(&self, axis: usize, value: f64) -> Result<f64, OutOfBounds> {
        if value.is_nan() {
            return Err(OutOfBounds { axis, value });
        }
        let (low, high) = self.bounds[axis];
        Ok((value.clamp(low, high) - low) / (high - low))
    }

    /// Writes 1, and then `order` features of each component: `write` receives the component in [0, 1], and the place for its
    /// features.
    #[inline]
    pub(super) fn write_uncoupled<T: Float>(
        &self,
        order: usize,
        observation: &[T],
        features: &mut [f64],
        mut write: impl FnMut(f64, &mut [f64]),
    ) -> Result<(), OutOfBounds> {
        let (constant, rest) = features.split_at_mut(1);
        constant[0] = 1.0;
        for (axis, (&value, features)) in observation.iter().zip(rest.chunks_exact_mut(order)).enumerate() {
            write(self.scale(axis, value.into())?, features);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_whose_difference_overflows_are_refused() {
        let refused = ScaledBox::try_new(&[0.0, -1e308], &[1.0, 1e308]).map_err(|error| error.to_string());
        let distant = "high must be a finite distance above low, got 1e308 above -1e308 for component 1";
        assert_eq!(refused, Err(distant.to_owned()));
        let widest = ScaledBox::try_new(&[f64::MIN / 2.0], &[f64::MAX / 2.0]).expect("a finite difference");
        assert_eq!([f64::MIN, 0.0, f64::INFINITY].map(|value| widest.scale(0, value)), [Ok(0.0), Ok(0.5), Ok(1.0)]);
    }
}
