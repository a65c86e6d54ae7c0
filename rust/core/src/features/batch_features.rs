//! Features that find the active rows of several observations at once.

use super::{Features, LaneRows};
use crate::simd::{F32s, Simd};

/// Features of `M` components that find the active rows of several observations at once.
pub trait BatchFeatures<const M: usize>: Features<[f32; M]> + Clone + PartialEq {
    /// The active rows as a lane holds them.
    type ActiveInLane: LaneRows<Active = Self::Active>;

    /// Writes the active rows of the observation in each lane, given component by component. Returns `false` if one of them
    /// has no row; the rows are then of no use.
    #[must_use]
    fn write_active_rows_batch<S: Simd, const K: usize>(
        &self,
        simd: S,
        observations: [F32s<S, K>; M],
        active: &mut [Self::ActiveInLane; K],
    ) -> bool;
}
