//! A grid of rounded cells, the article's discretizer: `np.round((observation - low) * scale)`.

use std::marker::PhantomData;

use super::{BatchFeatures, Features, OutOfBounds};
use crate::errors::BuildError;
use crate::numeric::Float;
use crate::simd::{F32s, Mask, Simd, U64s};

/// Adding this to a number below 2⁵¹ in magnitude rounds it, half to even, and leaves the integer in the low bits of
/// the sum. This is faster than calling `rint` and converting the result.
const ROUND_TO_INTEGER: f64 = 6_755_399_441_055_744.0; // 1.5 × 2⁵²

/// The cells of one component of the observation, in the dtype `T` of its bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis<T> {
    low: T,
    scale: f64,
    size: u32,
}

impl<T: Float> Axis<T> {
    /// Cells from `low` to `high`, both included, with `scale` cells per unit.
    pub fn new(low: T, high: T, scale: f64) -> Self {
        let last = ((high - low).into() * scale).round_ties_even();
        Self { low, scale, size: (last as u32).saturating_add(1) }
    }

    /// As [`new`](Self::new), checked.
    ///
    /// # Errors
    /// If a bound is not finite, `high` is below `low`, `scale` is not above 0, or there are 2³² cells or more.
    pub fn try_new(low: T, high: T, scale: f64) -> Result<Self, BuildError> {
        let [lower, upper]: [f64; 2] = [low.into(), high.into()];
        let in_order = lower.is_finite() && upper.is_finite() && lower <= upper;
        BuildError::check(in_order, "high", format_args!("finite and at least low, {lower}"), upper)?;
        let fits = scale > 0.0 && (upper - lower) * scale < f64::from(u32::MAX);
        BuildError::check(fits, "scale", "above 0, for fewer than 2**32 cells", scale)?;
        Ok(Self::new(low, high, scale))
    }

    /// The number of cells.
    pub fn size(&self) -> usize {
        self.size as usize
    }

    /// The cell of a value, if it has one. The subtraction is in `T` and the product in f64, as in `NumPy`'s type
    /// promotion.
    #[inline]
    fn cell(&self, value: T) -> Option<u32> {
        let cell = self.rounded(value);
        // One comparison suffices: negative numbers, NaN and numbers too large to round become huge integers.
        (cell < u64::from(self.size)).then_some(cell as u32)
    }

    /// The rounded product as an integer, before the range check.
    #[inline]
    fn rounded(&self, value: T) -> u64 {
        let sum = (value - self.low).into() * self.scale + ROUND_TO_INTEGER;
        sum.to_bits().wrapping_sub(ROUND_TO_INTEGER.to_bits())
    }
}

/// A grid of rounded cells for observations of dtype `T`: one row per cell, in C order. `A` is an array of axes, or a
/// `Vec` if their number is known only at run time.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounding<T, A = Vec<Axis<T>>> {
    axes: A,
    dtype: PhantomData<T>,
}

impl<T: Float, A: AsRef<[Axis<T>]>> Rounding<T, A> {
    /// The grid with these axes.
    pub fn new(axes: A) -> Self {
        Self { axes, dtype: PhantomData }
    }

    /// The number of components of an observation.
    pub fn dimensions(&self) -> usize {
        self.axes.as_ref().len()
    }

    /// The number of cells, each of which has a row of the table.
    pub fn n_rows(&self) -> usize {
        Features::<[T]>::len(self)
    }

    /// The number of cells along each axis.
    pub fn shape(&self) -> Vec<usize> {
        self.axes.as_ref().iter().map(Axis::size).collect()
    }

    /// The active row of an observation.
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    pub(super) fn row(&self, observation: &[T]) -> Result<[u32; 1], OutOfBounds> {
        let mut row = 0;
        for (index, (axis, &value)) in self.axes.as_ref().iter().zip(observation).enumerate() {
            let Some(cell) = axis.cell(value) else {
                return Err(OutOfBounds { axis: index, value: value.into() });
            };
            row = row * axis.size + cell;
        }
        Ok([row])
    }
}

impl<T: Float, A: AsRef<[Axis<T>]>, O: AsRef<[T]> + ?Sized> Features<O> for Rounding<T, A> {
    type Active = [u32; 1];

    #[inline]
    fn active_rows(&self, observation: &O) -> Result<[u32; 1], OutOfBounds> {
        self.row(observation.as_ref())
    }

    fn len(&self) -> usize {
        self.axes.as_ref().iter().map(Axis::size).product()
    }
}

impl<const M: usize> BatchFeatures<M> for Rounding<f32, [Axis<f32>; M]> {
    type ActiveInLane = usize;

    #[inline(always)]
    fn write_active_rows_batch<S: Simd, const K: usize>(
        &self,
        simd: S,
        observations: [F32s<S, K>; M],
        active: &mut [usize; K],
    ) -> bool {
        let mut rows = U64s::splat(simd, 0);
        let mut outside = Mask::new(simd, [false; K]);
        for (axis, values) in self.axes.iter().zip(observations) {
            let size = u64::from(axis.size);
            let sums = (values - axis.low).to_f64s() * axis.scale + ROUND_TO_INTEGER;
            let cells = sums.to_bits() - ROUND_TO_INTEGER.to_bits();
            outside = outside | !cells.less(size);
            // Rows are below 2³². The cell of a value out of bounds may be any integer.
            rows = rows.mul_lower(size) + cells;
        }
        *active = rows.to_array().map(|row| row as usize);
        !outside.any()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn article() -> Rounding<f32, [Axis<f32>; 2]> {
        Rounding::new([Axis::new(-1.2, 0.6, 10.0), Axis::new(-0.07, 0.07, 100.0)])
    }

    #[test]
    fn the_articles_grid_has_285_cells() {
        assert_eq!((article().shape(), article().n_rows()), (vec![19, 15], 285));
        assert_eq!(Features::<[f32; 2]>::len(&article()), 285);
    }

    #[test]
    fn the_corners_are_the_first_and_the_last_row() {
        assert_eq!(article().active_rows(&[-1.2, -0.07]), Ok([0]));
        assert_eq!(article().active_rows(&[0.6, 0.07]), Ok([284]));
    }

    #[test]
    fn halves_round_to_even() {
        let halves = Rounding::new([Axis::new(0.0_f64, 10.0, 1.0)]);
        for (value, row) in [(0.5, 0), (1.5, 2), (2.5, 2), (3.5, 4)] {
            assert_eq!(halves.active_rows(&[value]), Ok([row]));
        }
    }

    #[test]
    fn invalid_axes_are_refused_by_name() {
        let error = |low, high, scale| Axis::try_new(low, high, scale).map_err(|error| error.to_string());
        assert_eq!(error(1.0_f64, 0.0, 1.0), Err("high must be finite and at least low, 1, got 0".into()));
        assert_eq!(error(0.0, 1.0, -1.0), Err("scale must be above 0, for fewer than 2**32 cells, got -1".into()));
        assert!(error(0.0, 1e10, 1.0).is_err() && error(0.0, f64::INFINITY, 1.0).is_err());
        assert_eq!(error(0.0, 10.0, 1.0), Ok(Axis::new(0.0, 10.0, 1.0)));
    }

    #[test]
    fn out_of_bounds_names_the_component() {
        for value in [-1.4_f32, 0.8, 1e30, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(matches!(article().active_rows(&[value, 0.0]), Err(OutOfBounds { axis: 0, .. })));
        }
    }

    proptest! {
        #[test]
        fn a_cell_is_the_rounded_product_if_it_is_in_range(value in prop_oneof![-2.0..12.0, any::<f64>()], size in 1_u32..12) {
            let axis = Axis { low: 0.0, scale: 1.0, size };
            let rounded = f64::round_ties_even(value);
            let inside = rounded >= 0.0 && rounded < f64::from(size);
            prop_assert_eq!(axis.cell(value), inside.then_some(rounded as u32));
        }
    }
}
