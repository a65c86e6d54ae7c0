//! A grid chosen at run time.

use super::{Bins, Features, OutOfBounds, Rounding};
use crate::numeric::Float;

/// One of the grids, chosen at run time.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyGrid<T> {
    /// Cells by rounding, as in the article.
    Rounding(Rounding<T>),
    /// Bins between edges.
    Bins(Bins<T>),
}

impl<T: Float, O: AsRef<[T]> + ?Sized> Features<O> for AnyGrid<T> {
    type Active = [u32; 1];

    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn active_rows(&self, observation: &O) -> Result<[u32; 1], OutOfBounds> {
        match self {
            Self::Rounding(grid) => grid.row(observation.as_ref()),
            Self::Bins(grid) => grid.active_rows(observation),
        }
    }

    fn len(&self) -> usize {
        match self {
            Self::Rounding(grid) => Features::<O>::len(grid),
            Self::Bins(grid) => Features::<O>::len(grid),
        }
    }
}
