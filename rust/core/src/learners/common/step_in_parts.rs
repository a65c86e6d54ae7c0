//! A step that may take so long that it is done in parts.

use super::MAX_WORK_PER_CALL;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};

/// How far the learning from a step is done, for the methods of which one step can take longer than a user who pressed Ctrl-C
/// should wait: those that learn when an episode ends, n-step methods, whose work then grows with n², and batch TD, which
/// repeats itself until the values settle.
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

    /// Calls `part` until nothing is left to do, or until the work of one call is done. `part` returns its work, and whether
    /// something is left to do.
    pub(crate) fn advance(&mut self, mut part: impl FnMut() -> (u64, bool)) {
        (self.is_unfinished, self.work) = (true, 0);
        while self.is_unfinished && self.work < MAX_WORK_PER_CALL {
            let (work, is_unfinished) = part();
            self.work += work;
            self.is_unfinished = is_unfinished;
        }
    }

    /// Forgets what is left to do, and the work of the last call.
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

/// Whether something is left to do; the work only measures.
impl Persist for StepInParts {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.is_unfinished.persist(checkpoint)
    }
}
