//! The active rows of an observation in the representation of a batch.

use super::{ActiveRows, FixedTiles};

/// The active rows of one lane of a batch. A single row is stored in 64 bits, like every other number of a lane.
pub trait LaneRows: Copy + Default {
    /// Whether an observation always has exactly one row.
    const IS_SINGLE: bool;

    /// [`Features::Active`](super::Features::Active).
    type Active: ActiveRows;

    /// Converts the rows that features returned.
    fn new(active: Self::Active) -> Self;

    /// The rows in the type that features return.
    fn active(self) -> Self::Active;

    /// The first row.
    fn first(self) -> usize;

    /// The rows, in the order in which a learner sums their values.
    fn indices(self) -> impl Iterator<Item = usize>;
}

impl LaneRows for usize {
    const IS_SINGLE: bool = true;

    type Active = [u32; 1];

    #[inline(always)]
    fn new([row]: [u32; 1]) -> Self {
        row as Self
    }

    #[inline(always)]
    fn active(self) -> [u32; 1] {
        [self as u32]
    }

    #[inline(always)]
    fn first(self) -> usize {
        self
    }

    #[inline(always)]
    fn indices(self) -> impl Iterator<Item = usize> {
        std::iter::once(self)
    }
}

impl<const N: usize> LaneRows for FixedTiles<N> {
    const IS_SINGLE: bool = N == 1;

    type Active = Self;

    #[inline(always)]
    fn new(active: Self) -> Self {
        active
    }

    #[inline(always)]
    fn active(self) -> Self {
        self
    }

    #[inline(always)]
    fn first(self) -> usize {
        self.rows()[0] as usize
    }

    #[inline(always)]
    fn indices(self) -> impl Iterator<Item = usize> {
        self.rows().into_iter().map(|row| row as usize)
    }
}
