//! How much of a step's planning is done.

use super::Agent;
use super::agent::MAX_WORK_PER_CALL;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};

/// The planning updates of a step, done in parts, so that a caller never waits long for a part.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::learners) struct PlanningProgress {
    /// The number of updates still to do.
    remaining: u32,
    /// The number of updates in the last part, and the update from the environment.
    updates: u32,
}

impl PlanningProgress {
    /// Begins the planning of a step.
    pub(in crate::learners) fn begin(&mut self, planning_steps: u32) {
        self.remaining = planning_steps;
    }

    /// How many updates to do now.
    pub(in crate::learners) fn take(&mut self, agent: &Agent) -> u32 {
        let most = (MAX_WORK_PER_CALL / agent.work()).max(1);
        let updates = u64::from(self.remaining).min(most) as u32;
        self.remaining -= updates;
        self.updates = 1 + updates;
        updates
    }

    /// Whether updates remain.
    #[inline]
    pub(in crate::learners) fn is_unfinished(&self) -> bool {
        self.remaining > 0
    }

    /// The work of the last part.
    pub(in crate::learners) fn work(&self, agent: &Agent) -> u64 {
        u64::from(self.updates) * agent.work()
    }
}

impl Persist for PlanningProgress {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        (&mut self.remaining, &mut self.updates).persist(checkpoint)
    }
}
