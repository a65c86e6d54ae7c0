//! Tile coding with asymmetric offsets (Sutton & Barto, section 9.5.4), densely indexed unless hashing is asked for.

use std::marker::PhantomData;

use super::hashing::{Hashed, mix};
use super::{Features, OutOfBounds};
use crate::numeric::Float;

/// The most tilings there can be.
pub const MAX_TILINGS: usize = 32;

/// The rows that an observation lights, one a tiling, with room for `M`: rows are handed on at every step, so that room
/// costs time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ActiveTiles<const M: usize = MAX_TILINGS> {
    rows: [u32; M],
    tilings: usize,
}

impl<const M: usize> AsRef<[u32]> for ActiveTiles<M> {
    #[inline]
    fn as_ref(&self) -> &[u32] {
        &self.rows[..self.tilings]
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis<const M: usize> {
    low: f64,
    high: f64,
    tiles_per_unit: f64,
    /// One more than the tiles asked for: the offsets push a tiling's first tile over the lower edge.
    tiles: u32,
    /// How many parts of a tile each tiling is shifted by.
    offsets: [u32; M],
}

/// So many tilings of the box, each shifted by its own part of a tile: by 1, 3, 5 … parts along the first, second,
/// third … component. Observations of dtype `T` become f64 first.
#[derive(Clone, Debug, PartialEq)]
pub struct TileCoding<T = f64, const M: usize = MAX_TILINGS> {
    axes: Vec<Axis<M>>,
    tilings: u32,
    hashed: Option<Hashed>,
    dtype: PhantomData<T>,
}

impl<T: Float, const M: usize> TileCoding<T, M> {
    /// Tilings over the box from `low` to `high`, with so many `tiles` along each component. Observations are clipped
    /// to the box.
    ///
    /// # Panics
    /// If there are no tilings, or more than `M`.
    pub fn new(low: &[f64], high: &[f64], tiles: &[u32], tilings: u32) -> Self {
        assert!((1..=M).contains(&(tilings as usize)), "tilings must lie in 1 to {M}");
        let axes: Vec<Axis<M>> = low
            .iter()
            .zip(high)
            .zip(tiles)
            .enumerate()
            .map(|(index, ((&low, &high), &tiles))| Axis {
                low,
                high,
                tiles_per_unit: f64::from(tiles) / (high - low),
                tiles: tiles + 1,
                offsets: std::array::from_fn(|tiling| tiling as u32 * (2 * index as u32 + 1) % tilings),
            })
            .collect();
        Self { axes, tilings, hashed: None, dtype: PhantomData }
    }

    /// The same over a table of so many `rows` for all tilings together, each row found by a hash of the tiling and the
    /// tile. Tiles that share a row share its value, and one observation may light a row twice.
    ///
    /// # Panics
    /// If there are no rows.
    #[must_use]
    pub fn hashed(self, rows: u32) -> Self {
        assert!(rows > 0, "hashed_rows must be at least 1");
        Self { hashed: Some(Hashed { rows }), ..self }
    }

    /// The rows of a table too large to be indexed densely, from the tile of each tiling along each component.
    #[inline(never)]
    fn hashed_rows(&self, observation: &[T], table: Hashed) -> Result<ActiveTiles<M>, OutOfBounds> {
        let mut hashes: [u64; M] = std::array::from_fn(|tiling| mix(0, tiling as u32));
        for (index, (axis, &value)) in self.axes.iter().zip(observation).enumerate() {
            let place = axis.place(index, value.into(), self.tilings)?;
            for (hash, offset) in hashes[..self.tilings as usize].iter_mut().zip(axis.offsets) {
                *hash = mix(*hash, place.tile(offset, self.tilings));
            }
        }
        Ok(ActiveTiles { rows: hashes.map(|hash| table.row(hash)), tilings: self.tilings as usize })
    }
}

/// Where a number lies along an axis: in parts of a tile, of which each has as many as there are tilings.
#[derive(Clone, Copy)]
struct TileCoordinate {
    tile: u32,
    rest: u32,
}

impl TileCoordinate {
    /// The tile of the tiling of that offset: `(parts + offset) / tilings`, of which only the remainder differs from
    /// tiling to tiling.
    #[inline]
    fn tile(self, offset: u32, tilings: u32) -> u32 {
        self.tile + u32::from(self.rest + offset >= tilings)
    }
}

impl<const M: usize> Axis<M> {
    #[inline]
    fn place(&self, index: usize, value: f64, tilings: u32) -> Result<TileCoordinate, OutOfBounds> {
        if value.is_nan() {
            return Err(OutOfBounds { axis: index, value });
        }
        let value = value.clamp(self.low, self.high);
        // It is not negative, so that the conversion is `floor`.
        let parts = ((value - self.low) * self.tiles_per_unit * f64::from(tilings)) as u32;
        let (tile, rest) = if tilings.is_power_of_two() {
            (parts >> tilings.trailing_zeros(), parts & (tilings - 1))
        } else {
            (parts / tilings, parts % tilings)
        };
        Ok(TileCoordinate { tile, rest })
    }
}

impl<T: Float, O: AsRef<[T]> + ?Sized, const M: usize> Features<O> for TileCoding<T, M> {
    type Active = ActiveTiles<M>;

    #[inline]
    fn active_rows(&self, observation: &O) -> Result<ActiveTiles<M>, OutOfBounds> {
        if let Some(table) = self.hashed {
            return self.hashed_rows(observation.as_ref(), table);
        }
        let tilings = self.tilings;
        let mut rows: [u32; M] = std::array::from_fn(|tiling| tiling as u32);
        for (index, (axis, &value)) in self.axes.iter().zip(observation.as_ref()).enumerate() {
            let place = axis.place(index, value.into(), tilings)?;
            for (row, offset) in rows[..tilings as usize].iter_mut().zip(axis.offsets) {
                *row = *row * axis.tiles + place.tile(offset, tilings);
            }
        }
        Ok(ActiveTiles { rows, tilings: tilings as usize })
    }

    fn len(&self) -> usize {
        match self.hashed {
            Some(table) => table.rows as usize,
            None => self.axes.iter().fold(self.tilings as usize, |rows, axis| rows * axis.tiles as usize),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_tiling_lights_one_row_of_its_own() {
        let tiles = TileCoding::<f64, 8>::new(&[0.0, 0.0], &[1.0, 1.0], &[4, 4], 8);
        for observation in [[0.0, 0.0], [1.0, 1.0], [0.3, 0.9]] {
            let Ok(n_active) = tiles.active_rows(&observation) else { unreachable!("it lies in the box") };
            let owners: Vec<u32> = n_active.as_ref().iter().map(|row| row / 25).collect();
            assert_eq!(owners, [0, 1, 2, 3, 4, 5, 6, 7]);
        }
        assert_eq!(Features::<[f64; 2]>::len(&tiles), 200);
    }

    #[test]
    fn neighbours_share_tiles_and_strangers_share_none() {
        let tiles = TileCoding::<f64, 8>::new(&[0.0, 0.0], &[1.0, 1.0], &[8, 8], 8);
        let shared = |left: [f64; 2], right: [f64; 2]| match (tiles.active_rows(&left), tiles.active_rows(&right)) {
            (Ok(left), Ok(right)) => left.as_ref().iter().zip(right.as_ref()).filter(|(l, r)| l == r).count(),
            _ => unreachable!("both lie in the box"),
        };
        assert_eq!(shared([0.5, 0.5], [0.5, 0.5]), 8);
        assert!((1..8).contains(&shared([0.5, 0.5], [0.53, 0.5])));
        assert_eq!(shared([0.1, 0.1], [0.9, 0.9]), 0);
    }

    #[test]
    fn a_hashed_table_has_the_rows_asked_for_and_lights_one_a_tiling() {
        let space = ([0.0; 12], [1.0; 12], [9; 12]);
        let tiles = TileCoding::<f64, 8>::new(&space.0, &space.1, &space.2, 8).hashed(1000);
        assert_eq!(Features::<[f64; 12]>::len(&tiles), 1000);
        let Ok(n_active) = tiles.active_rows(&[0.3; 12]) else { unreachable!("it lies in the box") };
        assert_eq!(n_active.as_ref().len(), 8);
        assert!(n_active.as_ref().iter().all(|&row| row < 1000));
        assert_ne!(tiles.active_rows(&[0.3; 12]), tiles.active_rows(&[0.7; 12]));
    }

    #[test]
    fn what_lies_outside_is_clipped_to_the_box() {
        let tiles = TileCoding::<f64, 8>::new(&[0.0], &[1.0], &[4], 4);
        assert_eq!(tiles.active_rows(&[-5.0]), tiles.active_rows(&[0.0]));
        assert_eq!(tiles.active_rows(&[f64::INFINITY]), tiles.active_rows(&[1.0]));
    }
}
