//! The trait of the models that Dyna-Q plans with.

use super::{Model, ModelEntry};
use crate::checkpoint::Persist;
use crate::memory::{AllocationError, RunMemory};
use crate::random::Rng;

/// A model of the environment, learned from its transitions.
pub trait DynaModel: Persist {
    /// The pairs that were tried, each with its last transition.
    fn tried(&self) -> &Model;

    /// Learns from a transition.
    fn record(&mut self, row: u32, action: usize, entry: ModelEntry);

    /// Samples an outcome of a pair; `None` if the pair was never tried.
    fn sample(&self, row: u32, action: usize, rng: &mut impl Rng) -> Option<ModelEntry>;

    /// The work of recording or sampling a transition, in addition to that of its row; 0 if it is a single lookup.
    #[inline]
    fn work(&self) -> u64 {
        0
    }

    /// Makes room for this many more transitions.
    ///
    /// # Errors
    /// `OutOfMemory`, `LimitReached`; `TooManyEntries` if they would exceed 32-bit indices.
    fn reserve(&mut self, _transitions: u64, _memory: &mut RunMemory) -> Result<(), AllocationError> {
        Ok(())
    }
}

impl DynaModel for Model {
    #[inline]
    fn tried(&self) -> &Self {
        self
    }

    #[inline]
    fn record(&mut self, row: u32, action: usize, entry: ModelEntry) {
        Self::record(self, row, action, entry);
    }

    #[inline]
    fn sample(&self, row: u32, action: usize, _rng: &mut impl Rng) -> Option<ModelEntry> {
        self.entry(row, action)
    }
}
