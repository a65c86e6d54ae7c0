//! Tile coding with asymmetric offsets (Sutton & Barto, section 9.5.4), with or without hashing.

use std::marker::PhantomData;

use super::checked_tilings::check_bounds;
use super::hashing::{HashTable, mix};
use super::{ActiveFeatures, Features, OutOfBounds};
use crate::errors::BuildError;
use crate::numeric::Float;

/// The maximum number of tilings.
pub const MAX_TILINGS: usize = 32;

/// The active tiles of an observation, one per tiling. `M` is the capacity: active rows are copied at every step, so a
/// smaller capacity is faster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ActiveTiles<const M: usize = MAX_TILINGS> {
    rows: [u32; M],
    tilings: usize,
}

impl<const M: usize> ActiveTiles<M> {
    /// The active tiles if all `M` tilings are used.
    #[inline]
    pub(super) fn rows(self) -> [u32; M] {
        self.rows
    }
}

impl<const M: usize> AsRef<[u32]> for ActiveTiles<M> {
    #[inline]
    fn as_ref(&self) -> &[u32] {
        &self.rows[..self.tilings]
    }
}

impl<const M: usize> ActiveFeatures for ActiveTiles<M> {}

impl<const M: usize> TryFrom<&[u32]> for ActiveTiles<M> {
    type Error = ();

    /// An error for more rows than the capacity.
    fn try_from(active: &[u32]) -> Result<Self, ()> {
        let mut rows = [0; M];
        rows.get_mut(..active.len()).ok_or(())?.copy_from_slice(active);
        Ok(Self { rows, tilings: active.len() })
    }
}

/// The tiles along one component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TiledAxis<const M: usize> {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) tiles_per_unit: f64,
    /// The number of tiles: one more than requested, because its offset moves the first tile across the lower bound.
    pub(super) tiles: u32,
    /// The offset of each tiling, in units of a tile divided by the number of tilings.
    pub(super) offsets: [u32; M],
}

/// Several tilings of a box. Along component `i` (from 0), tiling `t` of `n` is offset by `t (2i + 1) mod n` parts,
/// where a part is the n-th part of a tile. Observations of dtype `T` are converted to f64.
#[derive(Clone, Debug, PartialEq)]
pub struct TileCoding<T = f64, const M: usize = MAX_TILINGS> {
    axes: Vec<TiledAxis<M>>,
    tilings: u32,
    hash_table: Option<HashTable>,
    dtype: PhantomData<T>,
}

impl<T: Float, const M: usize> TileCoding<T, M> {
    /// As [`try_new`](TileCoding::try_new), without checking the bounds.
    ///
    /// # Panics
    /// If `tilings` is 0 or greater than `M`.
    pub fn new(low: &[f64], high: &[f64], tiles: &[u32], tilings: u32) -> Self {
        assert!((1..=M).contains(&(tilings as usize)), "tilings must lie in [1, {M}], got {tilings}");
        let axes: Vec<TiledAxis<M>> = low
            .iter()
            .zip(high)
            .zip(tiles)
            .enumerate()
            .map(|(index, ((&low, &high), &tiles))| TiledAxis {
                low,
                high,
                tiles_per_unit: f64::from(tiles) / (high - low),
                tiles: tiles + 1,
                offsets: std::array::from_fn(|tiling| tiling as u32 * (2 * index as u32 + 1) % tilings),
            })
            .collect();
        Self { axes, tilings, hash_table: None, dtype: PhantomData }
    }

    /// The same tilings over a table of `rows` rows, in which the row of each tile is given by its hash. Tiles whose
    /// hashes collide share a row, so the same row can be active twice.
    ///
    /// # Panics
    /// If `rows` is 0.
    #[must_use]
    pub fn hashed(self, rows: u32) -> Self {
        assert!(rows > 0, "hashed_rows must be at least 1");
        Self { hash_table: Some(HashTable { rows }), ..self }
    }

    /// The number of rows of the table.
    pub fn n_rows(&self) -> usize {
        Features::<[T]>::len(self)
    }

    /// The number of tilings.
    pub(super) fn tilings(&self) -> usize {
        self.tilings as usize
    }

    /// The tiles along each component.
    pub(super) fn axes(&self) -> &[TiledAxis<M>] {
        &self.axes
    }

    /// Whether the rows of tiles are given by their hashes.
    pub(super) fn is_hashed(&self) -> bool {
        self.hash_table.is_some()
    }

    /// The active rows with hashing. The hash of a tile mixes its tiling and its coordinates.
    #[inline(never)]
    fn hashed_rows(&self, observation: &[T], table: HashTable) -> Result<ActiveTiles<M>, OutOfBounds> {
        let mut hashes: [u64; M] = std::array::from_fn(|tiling| mix(0, tiling as u32));
        for (index, (axis, &value)) in self.axes.iter().zip(observation).enumerate() {
            let coordinate = axis.coordinate(index, value.into(), self.tilings)?;
            for (hash, offset) in hashes[..self.tilings as usize].iter_mut().zip(axis.offsets) {
                *hash = mix(*hash, coordinate.tile(offset, self.tilings));
            }
        }
        Ok(ActiveTiles { rows: hashes.map(|hash| table.row(hash)), tilings: self.tilings as usize })
    }
}

/// The position of a value along an axis, in parts of a tile: `tile * tilings + part`.
#[derive(Clone, Copy)]
struct TileCoordinate {
    tile: u32,
    part: u32,
}

impl TileCoordinate {
    /// The tile in the tiling with this offset: `(tile * tilings + part + offset) / tilings`, without the division.
    #[inline]
    fn tile(self, offset: u32, tilings: u32) -> u32 {
        self.tile + u32::from(self.part + offset >= tilings)
    }
}

impl<const M: usize> TiledAxis<M> {
    #[inline]
    fn coordinate(&self, index: usize, value: f64, tilings: u32) -> Result<TileCoordinate, OutOfBounds> {
        if value.is_nan() {
            return Err(OutOfBounds { axis: index, value });
        }
        let value = value.clamp(self.low, self.high);
        // The conversion rounds down, because the number is not negative.
        let parts = ((value - self.low) * self.tiles_per_unit * f64::from(tilings)) as u32;
        let (tile, part) = if tilings.is_power_of_two() {
            (parts >> tilings.trailing_zeros(), parts & (tilings - 1))
        } else {
            (parts / tilings, parts % tilings)
        };
        Ok(TileCoordinate { tile, part })
    }
}

impl<T: Float, O: AsRef<[T]> + ?Sized, const M: usize> Features<O> for TileCoding<T, M> {
    type Active = ActiveTiles<M>;

    #[inline]
    fn active_rows(&self, observation: &O) -> Result<ActiveTiles<M>, OutOfBounds> {
        if let Some(table) = self.hash_table {
            return self.hashed_rows(observation.as_ref(), table);
        }
        let tilings = self.tilings;
        let mut rows: [u32; M] = std::array::from_fn(|tiling| tiling as u32);
        for (index, (axis, &value)) in self.axes.iter().zip(observation.as_ref()).enumerate() {
            let coordinate = axis.coordinate(index, value.into(), tilings)?;
            for (row, offset) in rows[..tilings as usize].iter_mut().zip(axis.offsets) {
                *row = *row * axis.tiles + coordinate.tile(offset, tilings);
            }
        }
        Ok(ActiveTiles { rows, tilings: tilings as usize })
    }

    fn check(&self) -> Result<(), BuildError> {
        check_bounds(self.axes.iter().map(|axis| (axis.low, axis.high)))
    }

    fn len(&self) -> usize {
        match self.hash_table {
            Some(table) => table.rows as usize,
            None => self.axes.iter().fold(self.tilings as usize, |rows, axis| rows * axis.tiles as usize),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_tiling_has_one_active_tile() {
        let tiles = TileCoding::<f64, 8>::new(&[0.0, 0.0], &[1.0, 1.0], &[4, 4], 8);
        for observation in [[0.0, 0.0], [1.0, 1.0], [0.3, 0.9]] {
            let Ok(active) = tiles.active_rows(&observation) else { unreachable!("the observation is in the box") };
            let tilings: Vec<u32> = active.as_ref().iter().map(|row| row / 25).collect();
            assert_eq!(tilings, [0, 1, 2, 3, 4, 5, 6, 7]);
        }
        assert_eq!(Features::<[f64; 2]>::len(&tiles), 200);
    }

    #[test]
    fn near_observations_share_tiles_and_distant_ones_do_not() {
        let tiles = TileCoding::<f64, 8>::new(&[0.0, 0.0], &[1.0, 1.0], &[8, 8], 8);
        let shared = |left: [f64; 2], right: [f64; 2]| match (tiles.active_rows(&left), tiles.active_rows(&right)) {
            (Ok(left), Ok(right)) => left.as_ref().iter().zip(right.as_ref()).filter(|(l, r)| l == r).count(),
            _ => unreachable!("both observations are in the box"),
        };
        assert_eq!(shared([0.5, 0.5], [0.5, 0.5]), 8);
        assert!((1..8).contains(&shared([0.5, 0.5], [0.53, 0.5])));
        assert_eq!(shared([0.1, 0.1], [0.9, 0.9]), 0);
    }

    #[test]
    fn a_hashed_table_has_the_requested_rows_and_one_active_row_per_tiling() {
        let space = ([0.0; 12], [1.0; 12], [9; 12]);
        let tiles = TileCoding::<f64, 8>::new(&space.0, &space.1, &space.2, 8).hashed(1000);
        assert_eq!(Features::<[f64; 12]>::len(&tiles), 1000);
        let Ok(active) = tiles.active_rows(&[0.3; 12]) else { unreachable!("the observation is in the box") };
        assert_eq!(active.as_ref().len(), 8);
        assert!(active.as_ref().iter().all(|&row| row < 1000));
        assert_ne!(tiles.active_rows(&[0.3; 12]), tiles.active_rows(&[0.7; 12]));
    }

    #[test]
    fn observations_are_clipped_to_the_box() {
        let tiles = TileCoding::<f64, 8>::new(&[0.0], &[1.0], &[4], 4);
        assert_eq!(tiles.active_rows(&[-5.0]), tiles.active_rows(&[0.0]));
        assert_eq!(tiles.active_rows(&[f64::INFINITY]), tiles.active_rows(&[1.0]));
    }
}
