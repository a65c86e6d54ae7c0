//! Features that find the active rows of several observations at once.

use super::{Features, LaneRows};
use crate::simd::{F32s, Simd};

/// Features of `M` components that find the active rows of several observations at once.
pub trait BatchFeatures<const M: usize>: Features<[f32; M]> + Clone + PartialEq {
    /// The active rows as a lane holds them.
    type ActiveInLane: LaneRows<Active = Self::Active>;

    /// The active rows of the observation in each lane, given component by component; `None` if any of them has no row.
    fn active_rows_batch<S: Simd, const K: usize>(
        &self,
        simd: S,
        observations: [F32s<S, K>; M],
    ) -> Option<[Self::ActiveInLane; K]>;
}
