//! Runs that wait for their learner.

use qtab_core::learners::LearnerVisitor;
use qtab_core::random::Pcg64;
use qtab_core::{Learner, Task, Trainer};

use super::Run;
use crate::error::RunError;

/// A task and the agent's generator. With a learner, whatever its type, they become a boxed run.
pub(super) struct PendingRun<T> {
    pub(super) task: T,
    pub(super) rng: Pcg64,
}

impl<T> LearnerVisitor<[u32; 1]> for PendingRun<T>
where
    T: Task<Active = [u32; 1], State: Send> + Send + 'static,
    RunError: From<T::Error>,
{
    type Output = Box<dyn Run>;

    fn visit<L: Learner<[u32; 1]> + Send + 'static>(self, learner: L) -> Box<dyn Run> {
        Box::new(Trainer::new(self.task, learner, self.rng))
    }
}
