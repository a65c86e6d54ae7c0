//! The article's discretizer: `round((observation - low) * scale)`, half to even, as `NumPy` computes it.

use std::marker::PhantomData;

use super::{BatchFeatures, Features, OutOfBounds};
use crate::numeric::Float;

/// Adding this to |x| < 2⁵¹ leaves round-half-even(x) in the low bits of the sum: `rint` without a call, and the integer
/// for nothing.
const ROUND_TO_INTEGER: f64 = 6_755_399_441_055_744.0; // 1.5 × 2⁵²

/// One component of the observation, in the dtype `T` of the space's bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis<T> {
    low: T,
    scale: f64,
    size: u32,
}

impl<T: Float> Axis<T> {
    /// An axis from `low` to `high`, both included, with `scale` cells a unit.
    pub fn new(low: T, high: T, scale: f64) -> Self {
        let last = ((high - low).into() * scale).round_ties_even();
        Self { low, scale, size: last as u32 + 1 }
    }

    /// How many cells it has.
    pub fn size(&self) -> usize {
        self.size as usize
    }

    /// The subtraction is made in `T`, the product in f64: `NumPy`'s promotion of f32 with an array of numbers.
    #[inline]
    fn cell(&self, value: T) -> Option<u32> {
        let cell = self.shifted(value);
        // One comparison: what is negative, NaN or too large to round so lies far beyond any size as an integer.
        (cell < u64::from(self.size)).then_some(cell as u32)
    }

    #[inline]
    fn shifted(&self, value: T) -> u64 {
        let shifted = (value - self.low).into() * self.scale + ROUND_TO_INTEGER;
        shifted.to_bits().wrapping_sub(ROUND_TO_INTEGER.to_bits())
    }
}

/// A grid over the axes `A` (an array, or a `Vec` where their count is known at run time only), rows in C order.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounding<T, A = Vec<Axis<T>>> {
    axes: A,
    dtype: PhantomData<T>,
}

impl<T: Float, A: AsRef<[Axis<T>]>> Rounding<T, A> {
    /// The grid over these axes.
    pub fn new(axes: A) -> Self {
        Self { axes, dtype: PhantomData }
    }

    /// How many components an observation has.
    pub fn dimensions(&self) -> usize {
        self.axes.as_ref().len()
    }

    /// How many cells each axis has.
    pub fn shape(&self) -> Vec<usize> {
        self.axes.as_ref().iter().map(Axis::size).collect()
    }
}

impl<T: Float, A: AsRef<[Axis<T>]>, O: AsRef<[T]> + ?Sized> Features<O> for Rounding<T, A> {
    type Active = [u32; 1];

    #[inline]
    fn active_rows(&self, observation: &O) -> Result<[u32; 1], OutOfBounds> {
        let mut row = 0;
        for (index, (axis, &value)) in self.axes.as_ref().iter().zip(observation.as_ref()).enumerate() {
            let Some(cell) = axis.cell(value) else {
                return Err(OutOfBounds { axis: index, value: value.into() });
            };
            row = row * axis.size + cell;
        }
        Ok([row])
    }

    fn len(&self) -> usize {
        self.axes.as_ref().iter().map(Axis::size).product()
    }
}

impl<const M: usize> BatchFeatures<M> for Rounding<f32, [Axis<f32>; M]> {
    #[expect(clippy::inline_always, reason = "what is compiled for each instruction set must be inlined to be so")]
    #[inline(always)]
    fn active_rows_batch<const K: usize>(&self, observations: &[[f32; K]; M]) -> Option<[usize; K]> {
        let mut rows = [0_u64; K];
        let mut inside = true;
        for (axis, values) in self.axes.iter().zip(observations) {
            let size = u64::from(axis.size);
            for (row, &value) in rows.iter_mut().zip(values) {
                let cell = axis.shifted(value);
                inside &= cell < size;
                // A cell outside may be any number.
                *row = row.wrapping_mul(size).wrapping_add(cell);
            }
        }
        inside.then_some(rows.map(|row| row as usize))
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
        assert_eq!(article().shape(), [19, 15]);
        assert_eq!(Features::<[f32; 2]>::len(&article()), 285);
    }

    #[test]
    fn the_corners_are_the_first_and_the_last_row() {
        assert_eq!(article().active_rows(&[-1.2, -0.07]), Ok([0]));
        assert_eq!(article().active_rows(&[0.6, 0.07]), Ok([284]));
    }

    #[test]
    fn halves_go_to_the_even_cell() {
        let halves = Rounding::new([Axis::new(0.0_f64, 10.0, 1.0)]);
        for (value, row) in [(0.5, 0), (1.5, 2), (2.5, 2), (3.5, 4)] {
            assert_eq!(halves.active_rows(&[value]), Ok([row]));
        }
    }

    #[test]
    fn what_lies_outside_is_refused_and_named() {
        for value in [-1.4_f32, 0.8, 1e30, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(matches!(article().active_rows(&[value, 0.0]), Err(OutOfBounds { axis: 0, .. })));
        }
    }

    proptest! {
        #[test]
        fn a_cell_is_the_rounded_product_or_none(value in prop_oneof![-2.0..12.0, any::<f64>()], size in 1_u32..12) {
            let axis = Axis { low: 0.0, scale: 1.0, size };
            let rounded = f64::round_ties_even(value);
            let inside = rounded >= 0.0 && rounded < f64::from(size);
            prop_assert_eq!(axis.cell(value), inside.then_some(rounded as u32));
        }
    }
}
