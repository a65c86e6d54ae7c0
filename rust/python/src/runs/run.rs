//! A training run of any type.

use pyo3::prelude::*;
use qtab_core::checkpoint::{Checkpoint, CheckpointError, EpisodeProgress, Persist};
use qtab_core::memory::MemoryRoom;
use qtab_core::random::Rng;
use qtab_core::tasks::{OptimalActions, Recordings};
use qtab_core::{Budget, EpisodeLog, Learner, Task, Trainer, TrainingError};

use crate::error::RunError;
use crate::spec::InitialQSpec;

pub(crate) trait Run: Send {
    fn advance(&mut self, budget: Budget) -> Result<(), RunError>;

    /// An error where the learner has diverged.
    fn check(&self) -> Result<(), RunError>;

    fn episodes(&self) -> &EpisodeLog;

    /// Takes the finished episodes out. The run cannot be continued.
    fn take_episodes(&mut self) -> EpisodeLog;

    /// The values of each table, rows first.
    fn tables(&self) -> Vec<&[f64]>;

    /// How often each action was taken in each row; None where visits are not counted.
    fn visits(&self) -> Option<&[i64]>;

    /// Which actions the states have, row by row; None if each has all of them.
    fn action_masks(&self) -> Option<&[bool]>;

    /// How many updates were made from a model; None where that is not counted.
    fn planning_updates(&self) -> Option<u64>;

    /// The estimate of the average reward; None where none is learned.
    fn average_reward(&self) -> Option<f64>;

    /// Limits the memory that the learner takes from now on.
    fn limit_memory(&mut self, room: MemoryRoom);

    /// Saves or restores all but the tables and the finished episodes. Returns where in an episode the checkpoint was made.
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<EpisodeProgress, CheckpointError>;

    /// Takes over the tables and the finished episodes of a run that is resumed.
    fn restore(&mut self, episodes: EpisodeLog, tables: &[&[f64]]) -> Result<(), CheckpointError>;
}

/// An error where the tables of a finished run have overflowed. Learners notice an overflow in the values that they read;
/// this finds it in values that were not read again, too.
pub(crate) fn check_tables(run: &dyn Run, initial_q: &InitialQSpec) -> Result<(), RunError> {
    if initial_q.has_overflowed(&run.tables()) {
        return Err(RunError::Overflowed { episode: run.episodes().returns.len().saturating_sub(1) });
    }
    Ok(())
}

impl<W, L, D> Run for Trainer<W, L, D>
where
    W: Task<State: Send, Active: Send> + Send,
    RunError: From<W::Error>,
    L: Learner<W::Active> + Send,
    D: Rng + Clone + Persist + Send,
{
    fn advance(&mut self, budget: Budget) -> Result<(), RunError> {
        Trainer::advance(self, budget).map_err(<RunError as From<TrainingError<W::Error>>>::from)?;
        self.check()
    }

    fn check(&self) -> Result<(), RunError> {
        if self.learner().diverged() { Err(RunError::Diverged { episode: self.last_episode() }) } else { Ok(()) }
    }

    fn episodes(&self) -> &EpisodeLog {
        Trainer::episodes(self)
    }

    fn take_episodes(&mut self) -> EpisodeLog {
        Trainer::take_episodes(self)
    }

    fn tables(&self) -> Vec<&[f64]> {
        self.learner().tables()
    }

    fn visits(&self) -> Option<&[i64]> {
        self.task().visits()
    }

    fn action_masks(&self) -> Option<&[bool]> {
        self.learner().action_masks()
    }

    fn planning_updates(&self) -> Option<u64> {
        self.learner().planning_updates()
    }

    fn average_reward(&self) -> Option<f64> {
        self.learner().average_reward()
    }

    fn limit_memory(&mut self, room: MemoryRoom) {
        Trainer::limit_memory(self, room);
    }

    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<EpisodeProgress, CheckpointError> {
        Trainer::persist(self, checkpoint)
    }

    fn restore(&mut self, episodes: EpisodeLog, tables: &[&[f64]]) -> Result<(), CheckpointError> {
        Trainer::restore(self, episodes, tables)
    }
}

/// The last episodes of a run, where it records them.
pub(crate) enum AnyRecordings {
    None,
    /// By how many words the environment's generator had drawn when the episode began, and its buffered half-word.
    Native(Recordings<(u64, Option<u32>)>),
    /// By the state of the environment's generator when the episode began.
    Python(Recordings<Py<PyAny>>),
    /// Of a bandit: whether the optimal action was taken in each episode.
    OptimalActions(OptimalActions),
}

/// A run that has not started.
pub(crate) struct BuiltRun {
    pub(crate) run: Box<dyn Run>,
    pub(crate) recordings: AnyRecordings,
    /// Whether it steps a Python environment, and so needs the calling thread and the interpreter.
    pub(crate) steps_python: bool,
}
