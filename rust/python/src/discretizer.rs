//! How observations become rows, as Python describes it, and the features of that description.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::features::{AnyGrid, Axis, Bins, Edges, Rounding, TileCoding};
use qtab_core::numeric::Float;

use crate::plan::{Plan, unknown};

/// How observations become rows.
#[derive(FromPyObject)]
pub(crate) enum Discretizer {
    #[pyo3(from_item_all)]
    Rounding { scale: Vec<f64> },
    #[pyo3(from_item_all)]
    Tiles { low: Vec<f64>, high: Vec<f64>, tiles: Vec<u32>, tilings: u32, hashed_rows: Option<u32> },
    #[pyo3(from_item_all)]
    Cells { first: Vec<i64>, counts: Vec<u32>, scalar: bool },
    #[pyo3(from_item_all)]
    Bins { edges: Vec<Vec<f64>> },
}

impl Plan<'_> {
    /// The article's grid over two float32 components.
    pub(crate) fn plane(&self, scale: &[f64]) -> PyResult<Rounding<f32, [Axis<f32>; 2]>> {
        <[Axis<f32>; 2]>::try_from(self.axes(scale, |bound| bound as f32))
            .map(Rounding::new)
            .map_err(|axes| PyValueError::new_err(format!("scale must hold 2 numbers, got {}", axes.len())))
    }

    /// The grid of either kind, in the dtype of the bounds.
    pub(crate) fn grid<T: Float>(&self, dtype: impl Fn(f64) -> T) -> PyResult<AnyGrid<T>> {
        match &self.features {
            Discretizer::Rounding { scale } => Ok(AnyGrid::Rounding(Rounding::new(self.axes(scale, dtype)))),
            Discretizer::Bins { edges } => Ok(AnyGrid::Bins(Bins::new(self.axes_of(edges)?))),
            Discretizer::Tiles { .. } | Discretizer::Cells { .. } => Err(unknown("discretizer", "identity")),
        }
    }

    /// The axes of the article's grid.
    fn axes<T: Float>(&self, scale: &[f64], dtype: impl Fn(f64) -> T) -> Vec<Axis<T>> {
        let bounds = self.low.iter().zip(&self.high);
        bounds.zip(scale).map(|((&low, &high), &scale)| Axis::new(dtype(low), dtype(high), scale)).collect()
    }

    /// Bins over `N` float32 components.
    pub(crate) fn bins<const N: usize>(&self, edges: &[Vec<f64>]) -> PyResult<Bins<f32, [Edges; N]>> {
        self.axes_of(edges)?.try_into().map(Bins::new).map_err(|_| miscounted(N, edges))
    }

    fn axes_of(&self, edges: &[Vec<f64>]) -> PyResult<Vec<Edges>> {
        if edges.len() != self.low.len() {
            return Err(miscounted(self.low.len(), edges));
        }
        let rising = |edges: &&Vec<f64>| edges.is_sorted() && !edges.iter().any(|edge| edge.is_nan());
        let checked = |edges: &Vec<f64>| match Some(edges).filter(rising) {
            Some(edges) => Ok(Edges::new(edges.clone())),
            None => Err(PyValueError::new_err(format!("edges must rise, got {edges:?}"))),
        };
        edges.iter().map(checked).collect()
    }

    /// Tile coding.
    pub(crate) fn tiles<T: Float, const M: usize>(&self) -> PyResult<TileCoding<T, M>> {
        let Discretizer::Tiles { low, high, tiles, tilings, hashed_rows } = &self.features else {
            return Err(PyValueError::new_err("discretizer must be 'tiles'"));
        };
        if [low.len(), high.len(), tiles.len()].iter().any(|&length| length != self.low.len()) {
            return Err(PyValueError::new_err(format!("tiles must hold {} numbers", self.low.len())));
        }
        let tiles = TileCoding::new(low, high, tiles, *tilings);
        Ok(match *hashed_rows {
            Some(rows) => tiles.hashed(rows),
            None => tiles,
        })
    }
}

fn miscounted(components: usize, edges: &[Vec<f64>]) -> PyErr {
    PyValueError::new_err(format!("edges must hold a row for each of {components} components, got {}", edges.len()))
}
