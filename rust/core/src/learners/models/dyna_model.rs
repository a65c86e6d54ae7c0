//! The trait of the models that Dyna-Q plans with.

use super::{Model, ModelEntry};
use crate::checkpoint::Persist;
use crate::memory::{AllocationError, RunMemory};
use crate::random::Rng;

/// A model of the environment, learned from its transitions.
pub trait DynaModel: Persist {
    /// The number of actions.
    fn num_actions(&self) -> usize;

    /// Whether the model has not learned from any transition yet.
    fn is_empty(&self) -> bool;

    /// Learns from a transition.
    fn record(&mut self, row: u32, action: usize, entry: ModelEntry);

    /// A random row among those visited.
    fn sample_state(&self, rng: &mut impl Rng) -> u32;

    /// A random action among those tried in a visited row.
    fn sample_action(&self, row: u32, rng: &mut impl Rng) -> usize;

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
    fn reserve(&mut self, transitions: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        let (_, _) = (transitions, memory);
        Ok(())
    }
}

impl DynaModel for Model {
    fn num_actions(&self) -> usize {
        Self::num_actions(self)
    }

    fn is_empty(&self) -> bool {
        Self::is_empty(self)
    }

    #[inline]
    fn record(&mut self, row: u32, action: usize, entry: ModelEntry) {
        Self::record(self, row, action, entry);
    }

    #[inline]
    fn sample_state(&self, rng: &mut impl Rng) -> u32 {
        Self::sample_state(self, rng)
    }

    #[inline]
    fn sample_action(&self, row: u32, rng: &mut impl Rng) -> usize {
        Self::sample_action(self, row, rng)
    }

    #[inline]
    fn sample(&self, row: u32, action: usize, _rng: &mut impl Rng) -> Option<ModelEntry> {
        self.entry(row, action)
    }
}
