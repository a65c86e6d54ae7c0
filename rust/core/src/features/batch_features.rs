//! Grids that find the rows of several observations at once.

use super::Features;

/// A grid over `M` components that finds the rows of several observations at once, in SIMD lanes.
pub trait BatchFeatures<const M: usize>: Features<[f32; M], Active = [u32; 1]> + Clone + PartialEq {
    /// The row of each of `K` observations, given component by component; `None` if any of them has no row.
    fn active_rows_batch<const K: usize>(&self, observations: &[[f32; K]; M]) -> Option<[usize; K]>;
}
