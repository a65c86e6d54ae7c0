//! Tile coding compiled for the number of tilings and of components.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use std::array::TryFromSliceError;

use super::tile_coding::TiledAxis;
use super::{Features, OutOfBounds, TileCoding};
use crate::numeric::Float;

/// The active tiles, one per tiling. Their alignment is that of the vector registers in which they are computed and copied:
/// numbers that are read across the words in which they were written would stall the processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(16))]
pub struct FixedTiles<const N: usize>([u32; N]);

impl<const N: usize> AsRef<[u32]> for FixedTiles<N> {
    #[inline(always)]
    fn as_ref(&self) -> &[u32] {
        &self.0
    }
}

impl<const N: usize> TryFrom<&[u32]> for FixedTiles<N> {
    type Error = TryFromSliceError;

    fn try_from(active: &[u32]) -> Result<Self, TryFromSliceError> {
        active.try_into().map(Self)
    }
}

/// `N` tilings of a box of `D` components: the rows of [`TileCoding`], found without a loop.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedTileCoding<T, const D: usize, const N: usize> {
    axes: [FixedAxis; D],
    /// The first row of each tiling.
    first_rows: [u32; N],
    /// Hashing takes its time, so it needs no code of its own here.
    hashed: Option<Box<TileCoding<T, N>>>,
    len: usize,
}

/// The tiles along one component.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FixedAxis {
    low: f64,
    high: f64,
    tiles_per_unit: f64,
    /// The number of rows from one tile to the next.
    stride: u32,
}

impl<T: Float, const D: usize, const N: usize> FixedTileCoding<T, D, N> {
    /// The offset of each tiling along each component, in parts of a tile.
    const OFFSETS: [[u32; N]; D] = {
        let mut offsets = [[0; N]; D];
        let mut index = 0;
        while index < D {
            let mut tiling = 0;
            while tiling < N {
                offsets[index][tiling] = (tiling * (2 * index + 1) % N) as u32;
                tiling += 1;
            }
            index += 1;
        }
        offsets
    };

    /// The same rows as those of `tiles`; `None` if it has another number of tilings or of components.
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
            tiles_per_unit: axis.tiles_per_unit,
            stride: axis.tiles,
        });
        for axis in fixed.iter_mut().rev() {
            (axis.stride, stride) = (stride, axis.stride.wrapping_mul(stride));
        }
        let first_rows = std::array::from_fn(|tiling| (tiling as u32).wrapping_mul(stride));
        Some(Self { axes: fixed, first_rows, hashed: tiles.is_hashed().then(|| Box::new(tiles.clone())), len })
    }

    #[inline(never)]
    fn hashed_rows(tiles: &TileCoding<T, N>, observation: &[T; D]) -> Result<FixedTiles<N>, OutOfBounds> {
        tiles.active_rows(observation).map(|active| FixedTiles(active.rows()))
    }
}

impl<T: Float, const D: usize, const N: usize> Features<[T; D]> for FixedTileCoding<T, D, N> {
    type Active = FixedTiles<N>;

    #[inline(always)]
    fn active_rows(&self, observation: &[T; D]) -> Result<FixedTiles<N>, OutOfBounds> {
        if let Some(tiles) = &self.hashed {
            return Self::hashed_rows(tiles, observation);
        }
        let mut rows = self.first_rows;
        let mut first_tile = 0;
        for (index, axis) in self.axes.iter().enumerate() {
            let value = observation[index].into();
            if value.is_nan() {
                return Err(OutOfBounds { axis: index, value });
            }
            let value = if value < axis.low { axis.low } else { value };
            let value = if value > axis.high { axis.high } else { value };
            // The conversion rounds down, because the number is not negative.
            let parts = ((value - axis.low) * axis.tiles_per_unit * N as f64) as u32;
            let (tile, part) = (parts / N as u32, parts % N as u32);
            first_tile += tile * axis.stride;
            for (row, offset) in rows.iter_mut().zip(Self::OFFSETS[index]) {
                // Signed numbers are compared in one instruction.
                let next_tile = (part + offset).cast_signed() >= (N as u32).cast_signed();
                *row += if next_tile { axis.stride } else { 0 };
            }
        }
        Ok(FixedTiles(rows.map(|row| row + first_tile)))
    }

    fn len(&self) -> usize {
        self.len
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Compares the rows with those of tile coding in general.
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
        let fixed = FixedTileCoding::<f64, D, N>::new(&general).expect("the numbers agree");
        // Part of a box's width away from its lower bound, so that all tiles are met.
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
