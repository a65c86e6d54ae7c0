//! A training run of any type.

use qtab_core::features::ActiveRows;
use qtab_core::random::AgentRng;
use qtab_core::tasks::BoxedTask;
use qtab_core::{Budget, EpisodeLog, Learner, Task, Trainer, TrainingError};

use crate::failure::Failure;
use crate::updates::Watch;
use crate::updates::recorder::UpdateRecorder;

/// The unfinished episode of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Progress {
    pub(crate) episode_return: f64,
    pub(crate) steps: i64,
    /// The action to take next; `None` while the learner is still learning from the last step.
    pub(crate) next_action: Option<usize>,
}

pub(crate) trait Run {
    /// Trains until `episodes` episodes are finished or this much work is done.
    fn advance(&mut self, episodes: usize, work: u64) -> Result<(), Failure>;

    fn episodes(&self) -> &EpisodeLog;

    fn tables(&self) -> Vec<&[f64]>;

    fn visits(&self) -> Option<&[i64]>;

    fn diverged(&self) -> bool;

    /// The unfinished episode, if there is one.
    fn progress(&self) -> Option<Progress>;

    /// The watched updates of a state.
    fn watch(&self) -> Option<&Watch>;
}

impl<R: ActiveRows> Run for Trainer<BoxedTask<R, Failure>, UpdateRecorder<R>, AgentRng> {
    /// That a run has diverged is a state of the page, not a failure.
    fn advance(&mut self, episodes: usize, work: u64) -> Result<(), Failure> {
        match Trainer::advance(self, Budget { episodes, work }) {
            Err(TrainingError::Diverged { .. }) | Ok(()) => Ok(()),
            Err(TrainingError::Task(failure)) => Err(failure),
            Err(TrainingError::Allocation(error)) => Err(error.into()),
        }
    }

    fn episodes(&self) -> &EpisodeLog {
        Trainer::episodes(self)
    }

    fn tables(&self) -> Vec<&[f64]> {
        self.learner().tables()
    }

    fn visits(&self) -> Option<&[i64]> {
        self.task().visits()
    }

    fn diverged(&self) -> bool {
        self.learner().diverged()
    }

    fn progress(&self) -> Option<Progress> {
        let (episode_return, steps, action) = self.unfinished_episode()?;
        let next_action = (!self.learner().is_unfinished()).then_some(action);
        Some(Progress { episode_return, steps, next_action })
    }

    fn watch(&self) -> Option<&Watch> {
        self.learner().watch()
    }
}
