//! The checkpoint of a whole run.

use super::{EpisodeLog, EpisodeState, Trainer};
use crate::checkpoint::{Checkpoint, CheckpointError, EpisodeProgress, Persist};
use crate::features::{ActiveRows, persist_rows};
use crate::learners::Learner;
use crate::tasks::{Next, Task};

/// Saves or restores what followed an unfinished step.
fn persist_next<R: ActiveRows>(
    next: Option<Next<R>>,
    num_rows: usize,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Option<Next<R>>, CheckpointError> {
    let (mut kind, rows) = match next {
        None => (0_u8, None),
        Some(Next::NonTerminal(rows)) => (1, Some(rows)),
        Some(Next::Truncated(rows)) => (2, Some(rows)),
        Some(Next::Terminal) => (3, None),
    };
    kind.persist(checkpoint)?;
    Ok(match kind {
        0 => None,
        1 => Some(Next::NonTerminal(persist_rows(rows, num_rows, checkpoint)?)),
        2 => Some(Next::Truncated(persist_rows(rows, num_rows, checkpoint)?)),
        3 => Some(Next::Terminal),
        _ => return Err(CheckpointError::Invalid("end of a step")),
    })
}

impl<T: Task, L: Learner<T::Active>, R: Persist> Trainer<T, L, R> {
    /// Saves or restores the run, except for its tables and its finished episodes. A checkpoint is restored into a new run
    /// of the same task, learner and seed. Returns where in an episode the checkpoint was made.
    ///
    /// # Errors
    /// The bytes are damaged, or belong to another run. The run is then useless.
    pub fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<EpisodeProgress, CheckpointError> {
        self.rng.persist(checkpoint)?;
        self.learner.persist(checkpoint)?;
        let mut progress = match self.episode {
            Some(_) if self.task.resumes_episodes() => EpisodeProgress::Within,
            Some(_) => EpisodeProgress::Abandoned,
            None if self.abandoned => EpisodeProgress::Abandoned,
            None => EpisodeProgress::Between,
        };
        progress.persist(checkpoint)?;
        if progress == EpisodeProgress::Within {
            checkpoint.check(self.task.resumes_episodes(), "progress of an episode")?;
            self.persist_episode(checkpoint)?;
        } else {
            if checkpoint.is_restoring() && progress == EpisodeProgress::Abandoned {
                self.learner.abandon_episode();
            }
            self.task.persist(None, checkpoint)?;
        }
        let is_unfinished = self.episode.as_ref().is_some_and(|episode| episode.unfinished.is_some());
        checkpoint.check(self.learner.is_unfinished() == is_unfinished, "unfinished step")?;
        Ok(progress)
    }

    fn persist_episode(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        const INVALID: CheckpointError = CheckpointError::Invalid("state of the environment");
        let mut episode = if let Some(episode) = &self.episode {
            *episode
        } else {
            // Any state will do, and the generator is restored after it.
            let (state, active) = self.task.reset().map_err(|_| INVALID)?;
            EpisodeState { state, active, action: 0, episode_return: 0.0, length: 0, unfinished: None }
        };
        let (num_rows, num_actions) = self.learner.shape();
        self.task.persist(Some(&mut episode.state), checkpoint)?;
        checkpoint.index(&mut episode.action, num_actions, "action")?;
        (&mut episode.episode_return, &mut episode.length).persist(checkpoint)?;
        checkpoint.check(episode.length >= 0, "number of steps taken")?;
        if checkpoint.is_restoring() {
            episode.active = self.task.active_rows(&episode.state).map_err(|_| INVALID)?;
        }
        episode.unfinished = persist_next(episode.unfinished, num_rows, checkpoint)?;
        self.episode = Some(episode);
        Ok(())
    }

    /// Continues a run that has finished these episodes and learned these tables: the schedules move on to the episode
    /// after them. The rest of the run is restored by `persist`.
    ///
    /// # Errors
    /// The number of tables, or of their values, is another.
    pub fn restore(&mut self, episodes: EpisodeLog, tables: &[&[f64]]) -> Result<(), CheckpointError> {
        let ours = self.learner.tables_mut();
        if ours.len() != tables.len() || ours.iter().zip(tables).any(|(ours, theirs)| ours.len() != theirs.len()) {
            return Err(CheckpointError::Invalid("size of the tables"));
        }
        ours.into_iter().zip(tables).for_each(|(ours, theirs)| ours.copy_from_slice(theirs));
        self.learner.skip_episodes(episodes.returns.len());
        self.episodes = episodes;
        Ok(())
    }
}
