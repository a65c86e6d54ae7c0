//! The trait of runs that can be trained in batches.

use crate::features::OutOfBounds;
use crate::trainer::Budget;

/// A run that several of can be trained together.
pub trait BatchedRun: Sized {
    /// Advances every run by up to `budget.steps` steps, until one of them has `budget.episodes` episodes. Afterwards
    /// each run is in the state it would be in had it taken as many steps alone, and can be continued in any batch or
    /// alone.
    ///
    /// Runs advance one after the other if they differ in more than their seeds, tables and learning rates, or when one
    /// of them reaches an observation without a row.
    ///
    /// # Errors
    /// As [`Trainer::advance`](crate::Trainer::advance), with the index of the run that failed. The others can be
    /// continued.
    fn advance_all<const K: usize>(runs: &mut [Self; K], budget: Budget) -> Result<(), (usize, OutOfBounds)>;
}
