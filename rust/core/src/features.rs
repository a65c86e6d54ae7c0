//! From an observation to the rows of the table that it lights.

mod bins;
mod grid;
mod hashing;
mod identity;
mod real;
mod rounding;
mod tiles;

use std::error::Error;
use std::fmt;

pub use bins::{Bins, Edges};
pub use grid::Grid;
pub use identity::{Cells, Identity};
pub use real::Real;
pub use rounding::{Axis, Rounding};
pub use tiles::{Lit, MOST_TILINGS, Tiles};

/// An observation that the features have no row for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outside {
    /// Which component of the observation.
    pub axis: usize,
    /// Its value.
    pub value: f64,
}

impl fmt::Display for Outside {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "observation[{}] is {}, outside the observation space", self.axis, self.value)
    }
}

impl Error for Outside {}

/// What a table is indexed with: a grid lights one row, tile coding several.
pub trait Features<O: ?Sized> {
    /// The rows lit, in the order in which a learner sums them.
    type Rows: Copy + AsRef<[u32]>;

    /// The rows of an observation.
    ///
    /// # Errors
    /// An observation outside the table; a row is never wrapped round or clamped by accident.
    fn rows(&self, observation: &O) -> Result<Self::Rows, Outside>;

    /// How many rows the table has.
    fn len(&self) -> usize;

    /// Whether the table has no rows.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A grid that finds the rows of many lanes at once.
pub trait Lanes<const M: usize>: Features<[f32; M], Rows = [u32; 1]> + Clone + PartialEq {
    /// The rows of `K` observations, given component by component; none where one of them has no row.
    fn rows_of_lanes<const K: usize>(&self, observations: &[[f32; K]; M]) -> Option<[usize; K]>;
}
