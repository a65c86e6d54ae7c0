//! A step that is done in parts because it can take long.

use super::MAX_WORK_PER_CALL;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};

/// The progress of learning from a step, for methods in which one step can take longer than a user should wait after
/// pressing Ctrl-C: those that learn when an episode ends, n-step methods, whose work then grows with n², and batch TD,
/// which repeats its updates until the values converge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StepInParts {
    is_unfinished: bool,
    /// The work of the last call.
    work: u64,
}

impl StepInParts {
    pub(crate) fn new() -> Self {
        Self { is_unfinished: false, work: 0 }
    }

    /// Calls `part` until no work remains or the work of one call is done. `part` returns its work and whether any
    /// remains.
    pub(crate) fn advance(&mut self, mut part: impl FnMut() -> (u64, bool)) {
        (self.is_unfinished, self.work) = (true, 0);
        while self.is_unfinished && self.work < MAX_WORK_PER_CALL {
            let (work, is_unfinished) = part();
            self.work += work;
            self.is_unfinished = is_unfinished;
        }
    }

    /// Discards the remaining work and resets the work of the last call.
    pub(crate) fn clear(&mut self) {
        *self = Self::new();
    }

    #[inline]
    pub(crate) fn is_unfinished(&self) -> bool {
        self.is_unfinished
    }

    #[inline]
    pub(crate) fn work(&self) -> u64 {
        self.work
    }
}

/// Saves whether work remains. The work of the last call is only a measurement.
impl Persist for StepInParts {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.is_unfinished.persist(checkpoint)
    }
}
