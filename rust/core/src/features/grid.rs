//! A grid of either kind: cells rounded to, or bins between edges.

use super::{Bins, Features, Outside, Real, Rounding};

/// One row for each observation, by whichever rule was chosen at run time.
#[derive(Clone, Debug, PartialEq)]
pub enum Grid<T> {
    /// The article's.
    Rounding(Rounding<T>),
    /// `np.digitize`'s.
    Bins(Bins<T>),
}

impl<T: Real, O: AsRef<[T]> + ?Sized> Features<O> for Grid<T> {
    type Rows = [u32; 1];

    #[inline]
    fn rows(&self, observation: &O) -> Result<[u32; 1], Outside> {
        match self {
            Self::Rounding(grid) => grid.rows(observation),
            Self::Bins(grid) => grid.rows(observation),
        }
    }

    fn len(&self) -> usize {
        match self {
            Self::Rounding(grid) => Features::<O>::len(grid),
            Self::Bins(grid) => Features::<O>::len(grid),
        }
    }
}
