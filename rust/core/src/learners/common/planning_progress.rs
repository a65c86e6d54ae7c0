//! How much of a step's planning is done.

use super::agent::{MAX_WORK_PER_CALL, row_work};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};

/// The planning updates of a step, done in parts, so that a caller never waits long for a part.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanningProgress {
    /// The number of updates still to do.
    remaining: u32,
    /// The work of the last part.
    work: u64,
    /// The work of reading and updating a row.
    row_work: u64,
}

impl PlanningProgress {
    /// Before the first step, with rows of so many values.
    pub(in crate::learners) fn new(num_actions: usize) -> Self {
        let row_work = row_work(num_actions);
        Self { remaining: 0, work: row_work, row_work }
    }

    /// Begins the planning of a step.
    #[inline]
    pub(in crate::learners) fn begin(&mut self, planning_steps: u32) {
        self.remaining = planning_steps;
    }

    /// How many updates to do now, where the model does so much work for each.
    #[inline]
    pub(in crate::learners) fn take(&mut self, model_work: u64) -> u32 {
        let update_work = self.row_work + model_work;
        let updates = self.remaining.min((MAX_WORK_PER_CALL / update_work).max(1) as u32);
        self.remaining -= updates;
        self.work = u64::from(1 + updates) * update_work;
        updates
    }

    /// Gives up what remains.
    pub(in crate::learners) fn abandon(&mut self) {
        self.remaining = 0;
    }

    /// Whether updates remain.
    #[inline]
    pub(in crate::learners) fn is_unfinished(&self) -> bool {
        self.remaining > 0
    }

    /// The work of the last part.
    #[inline]
    pub(in crate::learners) fn work(&self) -> u64 {
        self.work
    }
}

/// What is done of it; the rest only measures.
impl Persist for PlanningProgress {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.remaining.persist(checkpoint)
    }
}
