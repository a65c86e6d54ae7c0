//! The trait of tasks whose random generator can be recorded.

use super::Task;

/// A task that reports the state of the environment's random generator, so that an episode can be replayed.
pub trait RngSnapshot: Task {
    /// The state of the generator that the reset and the steps draw from.
    type Snapshot;

    /// The state of the generator now.
    ///
    /// # Errors
    /// Whatever the environment raises.
    fn rng_snapshot(&self) -> Result<Self::Snapshot, Self::Error>;
}
