//! The planning updates of a step.

use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::learners::MAX_WORK_PER_CALL;

/// The planning updates of a step, made in parts, so that a caller never waits long: a million updates, the maximum,
/// take seconds if states have many actions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Planning {
    /// The number of updates still to make.
    remaining: u32,
    /// The work of the last part.
    work: u64,
}

impl Planning {
    /// Begins the planning of a step.
    #[inline]
    pub(super) fn begin(&mut self, planning_steps: u32) {
        self.remaining = planning_steps;
    }

    /// The number of updates to make now, given the work of each. The step itself counts as one update.
    #[inline]
    pub(super) fn take(&mut self, work_per_update: u64) -> u32 {
        let updates = self.remaining.min((MAX_WORK_PER_CALL / work_per_update).max(1) as u32);
        self.remaining -= updates;
        self.work = u64::from(1 + updates) * work_per_update;
        updates
    }

    /// Calls `update` for the remaining updates, which may differ in work. `update` returns its work, or `None` if
    /// there is nothing left to update.
    pub(super) fn advance(&mut self, mut update: impl FnMut() -> Option<u64>) {
        self.work = 0;
        while self.remaining > 0 && self.work < MAX_WORK_PER_CALL {
            match update() {
                Some(work) => (self.remaining, self.work) = (self.remaining - 1, self.work + work),
                None => self.remaining = 0,
            }
        }
    }

    /// Discards the remaining updates.
    pub(super) fn clear(&mut self) {
        self.remaining = 0;
    }

    /// Whether updates remain.
    #[inline]
    pub(super) fn is_unfinished(&self) -> bool {
        self.remaining > 0
    }

    /// The work of the last part.
    #[inline]
    pub(super) fn work(&self) -> u64 {
        self.work
    }
}

/// Saves the number of updates still to make. The work is only a measurement.
impl Persist for Planning {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.remaining.persist(checkpoint)
    }
}
