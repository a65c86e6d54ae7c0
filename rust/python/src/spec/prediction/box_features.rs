//! The features of a Box, for any discretizer.

use pyo3::prelude::*;
use qtab_core::Features;
use qtab_core::features::{ActiveTiles, AnyGrid, OutOfBounds, TileCoding};
use qtab_core::numeric::Float;

use crate::convert::{BoxReader, ObservationReader};
use crate::error::RunError;
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

/// Finds the rows of observations of type `O`, which policies use to look up their tables.
pub(crate) trait ReadRows<O> {
    fn rows(&self, observation: &O) -> Result<ActiveTiles, RunError>;
}

impl<const M: usize> ReadRows<[f32; M]> for BoxFeatures<f32> {
    fn rows(&self, observation: &[f32; M]) -> Result<ActiveTiles, RunError> {
        Ok(self.active_rows(observation)?)
    }
}

impl<T: Float> ReadRows<Vec<T>> for BoxFeatures<T> {
    fn rows(&self, observation: &Vec<T>) -> Result<ActiveTiles, RunError> {
        Ok(self.active_rows(observation)?)
    }
}

impl<T: Float + Default + numpy::Element> ReadRows<Py<PyAny>> for BoxReader<T, BoxFeatures<T>> {
    fn rows(&self, observation: &Py<PyAny>) -> Result<ActiveTiles, RunError> {
        Python::attach(|py| ObservationReader::active_rows(self, observation.bind(py)))
    }
}
