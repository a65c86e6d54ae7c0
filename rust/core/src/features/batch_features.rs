//! Features that find the active rows of several observations at once.

use super::{Features, LaneRows};

/// Features of `M` components that find the active rows of several observations at once.
pub trait BatchFeatures<const M: usize>: Features<[f32; M]> + Clone + PartialEq {
    /// The active rows as a lane holds them.
    type ActiveInLane: LaneRows<Active = Self::Active>;

    /// The active rows of each of `K` observations, given component by component; `None` if any of them has no row.
    fn active_rows_batch<const K: usize>(&self, observations: &[[f32; K]; M]) -> Option<[Self::ActiveInLane; K]>;
}
