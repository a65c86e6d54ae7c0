//! A training run of any type.

use pyo3::prelude::*;
use qtab_core::checkpoint::{Checkpoint, CheckpointError, EpisodeProgress, Persist};
use qtab_core::features::ActiveFeatures;
use qtab_core::memory::MemoryRoom;
use qtab_core::random::Rng;
use qtab_core::tasks::{OptimalActions, Recordings};
use qtab_core::{Budget, EpisodeLog, Learner, Task, Trainer};

use crate::error::RunError;
use crate::spec::InitialQSpec;

pub(crate) trait Run: Send {
    fn advance(&mut self, budget: Budget) -> Result<(), RunError>;

    /// Returns an error if the learner has diverged.
    fn check(&self) -> Result<(), RunError>;

    fn episodes(&self) -> &EpisodeLog;

    /// Takes the finished episodes out, after which the run cannot continue.
    fn take_episodes(&mut self) -> EpisodeLog;

    /// The values of each table, rows first.
    fn tables(&self) -> Vec<&[f64]>;

    /// The number of times each action was taken in each row; None if visits are not counted.
    fn visits(&self) -> Option<&[i64]>;

    /// The available actions of the states, row by row; None if every state has all actions.
    fn action_masks(&self) -> Option<&[bool]>;

    /// The number of updates made from a model; None if they are not counted.
    fn planning_updates(&self) -> Option<u64>;

    /// The estimate of the average reward; None if none is learned.
    fn average_reward(&self) -> Option<f64>;

    /// Limits the memory that the learner takes from now on.
    fn limit_memory(&mut self, room: MemoryRoom);

    /// Saves or restores everything but the tables and the finished episodes. Returns the progress within the episode.
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<EpisodeProgress, CheckpointError>;

    /// Restores the tables and the finished episodes of a run that is resumed.
    fn restore(&mut self, episodes: EpisodeLog, tables: &[&[f64]]) -> Result<(), CheckpointError>;
}

/// Returns an error if the tables of a finished run have overflowed. Learners notice an overflow only in values that
/// they read again; this checks all values.
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
        Trainer::advance(self, budget).map_err(|error| RunError::of_training(error, W::Active::WEIGHTED))?;
        self.check()
    }

    fn check(&self) -> Result<(), RunError> {
        if self.learner().diverged() {
            return Err(RunError::Diverged { episode: self.last_episode(), weighted: W::Active::WEIGHTED });
        }
        Ok(())
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
    /// The number of words drawn from the environment's generator when the episode began, and its buffered half-word.
    Native(Recordings<(u64, Option<u32>)>),
    /// The state of the environment's generator when the episode began.
    Python(Recordings<Py<PyAny>>),
    /// For a bandit: whether the optimal action was taken in each episode.
    OptimalActions(OptimalActions),
}

/// A run that has not started.
pub(crate) struct BuiltRun {
    pub(crate) run: Box<dyn Run>,
    pub(crate) recordings: AnyRecordings,
    /// Whether it steps a Python environment, and so needs the calling thread and the interpreter.
    pub(crate) steps_python: bool,
}
