//! Tile coding compiled for the number of tilings and of components.

use std::array::TryFromSliceError;

use super::checked_tilings::check_bounds;
use super::tile_coding::TiledAxis;
use super::{ActiveFeatures, BatchFeatures, Features, OutOfBounds, TileCoding};
use crate::errors::BuildError;
use crate::numeric::Float;
use crate::simd::{F32s, Simd};

/// The active tiles, one per tiling. They are aligned like the vector registers in which they are computed and copied:
/// reading numbers across the words in which they were written would stall the processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(16))]
pub struct FixedTiles<const N: usize>([u32; N]);

impl<const N: usize> FixedTiles<N> {
    #[inline(always)]
    pub(super) fn rows(self) -> [u32; N] {
        self.0
    }
}

/// The first row of each tiling.
impl<const N: usize> Default for FixedTiles<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

impl<const N: usize> AsRef<[u32]> for FixedTiles<N> {
    #[inline(always)]
    fn as_ref(&self) -> &[u32] {
        &self.0
    }
}

impl<const N: usize> ActiveFeatures for FixedTiles<N> {}

impl<const N: usize> TryFrom<&[u32]> for FixedTiles<N> {
    type Error = TryFromSliceError;

    fn try_from(active: &[u32]) -> Result<Self, TryFromSliceError> {
        active.try_into().map(Self)
    }
}

/// `N` tilings of a box of `D` components: the rows of [`TileCoding`], found without a loop.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedTileCoding<T, const D: usize, const N: usize> {
    axes: [FixedAxis<N>; D],
    /// The first row of each tiling.
    first_rows: [u32; N],
    /// Finds the rows in the cases without specialized code: hashing, and boxes of almost no width.
    general: Option<Box<TileCoding<T, N>>>,
    len: usize,
}

/// The tiles along one component.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FixedAxis<const N: usize> {
    low: f64,
    high: f64,
    /// A part is the `N`-th part of a tile.
    parts_per_unit: f64,
    /// The distance in rows between neighbouring tiles.
    stride: u32,
    /// The offset of each tiling, in parts. Not a constant, because the compiler would then omit the zero and add the
    /// others one by one instead of as a vector.
    offsets: [u32; N],
}

impl<T: Float, const D: usize, const N: usize> FixedTileCoding<T, D, N> {
    /// A specialized version of `tiles`, with the same rows; `None` if its number of tilings or components differs.
    pub fn new(tiles: &TileCoding<T, N>) -> Option<Self> {
        let axes: &[TiledAxis<N>; D] = tiles.axes().try_into().ok()?;
        if tiles.tilings() != N {
            return None;
        }
        let len = Features::<[T; D]>::len(tiles);
        let mut stride = 1;
        // In C order, the last component is the fastest.
        let mut fixed = axes.map(|axis| FixedAxis {
            low: axis.low,
            high: axis.high,
            parts_per_unit: axis.tiles_per_unit * N as f64,
            stride: axis.tiles,
            offsets: axis.offsets,
        });
        for axis in fixed.iter_mut().rev() {
            (axis.stride, stride) = (stride, axis.stride.wrapping_mul(stride));
        }
        let first_rows = std::array::from_fn(|tiling| (tiling as u32).wrapping_mul(stride));
        // Only then is the product with the number of parts exactly `N` times that with the number of tiles.
        let scales = N.is_power_of_two() && fixed.iter().all(|axis| axis.parts_per_unit.is_finite());
        let general = (tiles.is_hashed() || !scales).then(|| Box::new(tiles.clone()));
        Some(Self { axes: fixed, first_rows, general, len })
    }

    #[inline(never)]
    fn write_general_rows(
        tiles: &TileCoding<T, N>,
        observation: &[T; D],
        active: &mut FixedTiles<N>,
    ) -> Result<(), OutOfBounds> {
        *active = FixedTiles(tiles.active_rows(observation)?.rows());
        Ok(())
    }

    /// The error of an observation with a NaN component.
    #[cold]
    fn out_of_bounds(values: [f64; D]) -> OutOfBounds {
        let axis = values.iter().position(|value| value.is_nan()).unwrap_or(0);
        OutOfBounds { axis, value: values[axis] }
    }
}

impl<T: Float, const D: usize, const N: usize> Features<[T; D]> for FixedTileCoding<T, D, N> {
    type Active = FixedTiles<N>;

    const USES_VECTORS: bool = true;

    #[inline(always)]
    fn active_rows(&self, observation: &[T; D]) -> Result<FixedTiles<N>, OutOfBounds> {
        let mut active = FixedTiles(self.first_rows);
        self.write_active_rows(observation, &mut active)?;
        Ok(active)
    }

    #[inline(always)]
    fn write_active_rows(&self, observation: &[T; D], active: &mut FixedTiles<N>) -> Result<(), OutOfBounds> {
        if let Some(tiles) = &self.general {
            return Self::write_general_rows(tiles, observation, active);
        }
        let values: [f64; D] = std::array::from_fn(|index| observation[index].into());
        // Avoids a branch for each component.
        if values.iter().fold(false, |any, value| any | value.is_nan()) {
            return Err(Self::out_of_bounds(values));
        }
        let mut rows = self.first_rows;
        for (axis, value) in self.axes.iter().zip(values) {
            let value = if value < axis.low { axis.low } else { value };
            let value = if value > axis.high { axis.high } else { value };
            // The conversion rounds down, because the number is not negative.
            let parts = ((value - axis.low) * axis.parts_per_unit) as u32;
            for (row, offset) in rows.iter_mut().zip(axis.offsets) {
                *row += (parts + offset) / N as u32 * axis.stride;
            }
        }
        *active = FixedTiles(rows);
        Ok(())
    }

    fn check(&self) -> Result<(), BuildError> {
        check_bounds(self.axes.iter().map(|axis| (axis.low, axis.high)))
    }

    fn len(&self) -> usize {
        self.len
    }
}

impl<const D: usize, const N: usize> BatchFeatures<D> for FixedTileCoding<f32, D, N> {
    type ActiveInLane = FixedTiles<N>;

    #[inline(always)]
    fn write_active_rows_batch<S: Simd, const K: usize>(
        &self,
        _simd: S,
        observations: [F32s<S, K>; D],
        active: &mut [FixedTiles<N>; K],
    ) -> bool {
        let observations = observations.map(F32s::to_array);
        let mut nan = false;
        for (lane, active) in active.iter_mut().enumerate() {
            let observation = observations.map(|values| values[lane]);
            nan |= self.write_active_rows(&observation, active).is_err();
        }
        !nan
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Compares the rows with those of the general tile coding.
    fn check<const D: usize, const N: usize>(
        low: [f64; D],
        width: [f64; D],
        tiles: [u32; D],
        observation: [f64; D],
        hashed: bool,
    ) {
        let high: [f64; D] = std::array::from_fn(|axis| low[axis] + width[axis]);
        let general = TileCoding::<f64, N>::new(&low, &high, &tiles, N as u32);
        let general = if hashed { general.hashed(1000) } else { general };
        let fixed = FixedTileCoding::<f64, D, N>::new(&general).expect("the numbers of tilings and components match");
        // Positions are relative to the box, so that all tiles are reached.
        let observation = std::array::from_fn(|axis| low[axis] + width[axis] * observation[axis]);
        let rows = general.active_rows(&observation).map(|active| active.as_ref().to_vec());
        assert_eq!(fixed.active_rows(&observation).map(|active| active.0.to_vec()), rows);
        assert_eq!(fixed.len(), Features::<[f64; D]>::len(&general));
    }

    fn position() -> impl Strategy<Value = f64> {
        let tile_edges = (0_u32..70, 1_u32..70).prop_map(|(tile, tiles)| f64::from(tile) / f64::from(tiles));
        prop_oneof![-0.1..1.1, tile_edges, Just(f64::INFINITY), Just(f64::NEG_INFINITY)]
    }

    proptest! {
        #[test]
        fn the_rows_are_those_of_tile_coding(
            low in prop::array::uniform4(-5.0..5.0),
            width in prop::array::uniform4(1e-3..10.0),
            tiles in prop::array::uniform4(1_u32..12),
            observation in prop::array::uniform4(position()),
            hashed in any::<bool>(),
        ) {
            check::<4, 8>(low, width, tiles, observation, hashed);
            check::<4, 32>(low, width, tiles, observation, hashed);
            let two = |numbers: [f64; 4]| [numbers[0], numbers[1]];
            let (low, width, tiles, observation) = (two(low), two(width), [tiles[0], tiles[1]], two(observation));
            check::<2, 8>(low, width, tiles, observation, hashed);
            check::<2, 16>(low, width, tiles, observation, hashed);
            check::<2, 5>(low, width, tiles, observation, hashed);
        }
    }

    #[test]
    fn nan_has_no_row_and_other_tilings_do_not_fit() {
        let tiles = TileCoding::<f64, 8>::new(&[0.0], &[1.0], &[4], 8);
        assert!(FixedTileCoding::<f64, 1, 8>::new(&tiles).is_some_and(|fixed| fixed.active_rows(&[f64::NAN]).is_err()));
        assert!(FixedTileCoding::<f64, 2, 8>::new(&tiles).is_none());
        assert!(FixedTileCoding::<f64, 1, 8>::new(&TileCoding::new(&[0.0], &[1.0], &[4], 7)).is_none());
    }
}
