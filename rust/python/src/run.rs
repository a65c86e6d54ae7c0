//! A trainer of any type, as the pyclass holds it.

use std::any::Any;

use qtab_core::random::Rng;
use qtab_core::{Budget, EpisodeLog, Learner, Task, Trainer};

use crate::failure::Failure;

/// `Any`, because some kinds of runs are taken out of their boxes and batched.
pub(crate) trait Run: Any + Send {
    fn advance(&mut self, until: Budget) -> Result<(), Failure>;
    /// A failure, where the learner has diverged.
    fn check(&self) -> Result<(), Failure>;
    fn episodes(&self) -> &EpisodeLog;
    /// The tables' values, one table after the other, rows first.
    fn tables(&self) -> Vec<f64>;
}

impl<W, L, D> Run for Trainer<W, L, D>
where
    W: Task<Error: Into<Failure>, State: Send, Active: Send> + Send + 'static,
    L: Learner<W::Active> + Send + 'static,
    D: Rng + Clone + Send + 'static,
{
    fn advance(&mut self, until: Budget) -> Result<(), Failure> {
        Trainer::advance(self, until).map_err(Into::into)?;
        self.check()
    }

    fn check(&self) -> Result<(), Failure> {
        if self.learner().diverged() { Err(Failure::Diverged(self.last_episode())) } else { Ok(()) }
    }

    fn episodes(&self) -> &EpisodeLog {
        Trainer::episodes(self)
    }

    fn tables(&self) -> Vec<f64> {
        self.learner().tables().concat()
    }
}
