//! The features of a Box, for any discretizer.

use pyo3::prelude::*;
use qtab_core::Features;
use qtab_core::features::{ActiveTiles, AnyGrid, OutOfBounds, TileCoding};
use qtab_core::numeric::Float;

use crate::spec::DiscretizerSpec;

/// A grid or tilings of observations of dtype `T`.
#[derive(Clone, Debug)]
pub(crate) enum BoxFeatures<T> {
    Grid(AnyGrid<T>),
    Tiles(TileCoding<T>),
}

impl<T: Float> BoxFeatures<T> {
    pub(crate) fn new(spec: &DiscretizerSpec, to_dtype: impl Fn(f64) -> T) -> PyResult<Self> {
        match spec {
            DiscretizerSpec::Tiles(tiles) => Ok(Self::Tiles(tiles.tile_coding())),
            grid => Ok(Self::Grid(grid.grid(to_dtype)?)),
        }
    }
}

impl<T: Float, O: AsRef<[T]> + ?Sized> Features<O> for BoxFeatures<T> {
    type Active = ActiveTiles;

    #[inline]
    fn active_rows(&self, observation: &O) -> Result<ActiveTiles, OutOfBounds> {
        match self {
            Self::Grid(grid) => {
                let row = grid.active_rows(observation)?;
                Ok(ActiveTiles::try_from(&row[..]).unwrap_or_else(|()| unreachable!("there is room for a row")))
            }
            Self::Tiles(tiles) => tiles.active_rows(observation),
        }
    }

    fn len(&self) -> usize {
        match self {
            Self::Grid(grid) => Features::<O>::len(grid),
            Self::Tiles(tiles) => Features::<O>::len(tiles),
        }
    }
}
