//! A training run as a value, and the only training loop.

use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::learners::Learner;
use crate::random::Rng;
use crate::tasks::{Next, Task};

/// How far `advance` goes: it stops at whichever limit it reaches first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// The number of finished episodes, counted from the start of the run.
    pub episodes: usize,
    /// The number of steps, counted from the call.
    pub steps: u64,
}

/// The results of the finished episodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EpisodeLog {
    /// The return of each episode: the undiscounted sum of its rewards.
    pub returns: Vec<f64>,
    /// The number of steps of each episode.
    pub lengths: Vec<i64>,
    /// Whether each episode reached a terminal state, rather than only its time limit.
    pub terminated: Vec<bool>,
}

/// An unfinished episode.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EpisodeState<S, R> {
    pub(crate) state: S,
    /// The active rows of the state.
    pub(crate) active: R,
    /// The action to take next.
    pub(crate) action: usize,
    pub(crate) episode_return: f64,
    pub(crate) length: i64,
}

/// A task, a learner and the agent's random generator.
#[derive(Clone, Debug)]
pub struct Trainer<T: Task, L, R> {
    pub(crate) task: T,
    pub(crate) learner: L,
    pub(crate) rng: R,
    pub(crate) episodes: EpisodeLog,
    pub(crate) episode: Option<EpisodeState<T::State, T::Active>>,
}

impl<T: Task, L: Learner<T::Active>, R: Rng + Clone> Trainer<T, L, R> {
    /// A run before its first step.
    pub fn new(task: T, learner: L, rng: R) -> Self {
        Self { task, learner, rng, episodes: EpisodeLog::default(), episode: None }
    }

    /// The task.
    pub fn task(&self) -> &T {
        &self.task
    }

    /// The learner.
    pub fn learner(&self) -> &L {
        &self.learner
    }

    /// The finished episodes.
    pub fn episodes(&self) -> &EpisodeLog {
        &self.episodes
    }

    /// The index, from 0, of the unfinished episode, or of the last finished one if there is none.
    pub fn last_episode(&self) -> usize {
        let finished = self.episodes.returns.len();
        if self.episode.is_some() { finished } else { finished.saturating_sub(1) }
    }

    /// Trains until the budget is used up. The next call resumes exactly where this one stopped. A learner that has
    /// diverged stops after that episode.
    ///
    /// # Errors
    /// The task's error. What was learned before is kept; the episode in which it happened is not counted.
    pub fn advance(&mut self, budget: Budget) -> Result<(), T::Error> {
        // The generator and the episode are local variables: behind `self` each step would load and store them.
        let mut rng = self.rng.clone();
        let result = self.advance_with(&mut rng, budget);
        self.rng = rng;
        result
    }

    #[inline]
    fn advance_with(&mut self, rng: &mut R, budget: Budget) -> Result<(), T::Error> {
        let mut steps = budget.steps;
        while steps > 0 && self.episodes.returns.len() < budget.episodes && !self.learner.diverged() {
            let episode = match self.episode.take() {
                Some(episode) => episode,
                None => self.begin_episode(rng)?,
            };
            let EpisodeState { mut state, mut active, mut action, mut episode_return, mut length } = episode;
            loop {
                let transition = self.task.step(&mut state, action)?;
                episode_return += transition.reward;
                length += 1;
                steps -= 1;
                action = self.learner.learn(active, action, transition.reward, transition.next, rng);
                match transition.next {
                    Next::NonTerminal(next_active) => active = next_active,
                    Next::Truncated(_) => {
                        self.finish_episode(episode_return, length, false);
                        break;
                    }
                    Next::Terminal => {
                        self.finish_episode(episode_return, length, true);
                        break;
                    }
                }
                if steps == 0 {
                    self.episode = Some(EpisodeState { state, active, action, episode_return, length });
                    break;
                }
            }
        }
        Ok(())
    }

    pub(crate) fn begin_episode(&mut self, rng: &mut impl Rng) -> Result<EpisodeState<T::State, T::Active>, T::Error> {
        let (state, active) = self.task.reset()?;
        let action = self.learner.first_action(active, rng);
        Ok(EpisodeState { state, active, action, episode_return: 0.0, length: 0 })
    }

    pub(crate) fn finish_episode(&mut self, episode_return: f64, length: i64, terminated: bool) {
        self.learner.end_episode();
        self.episodes.returns.push(episode_return);
        self.episodes.lengths.push(length);
        self.episodes.terminated.push(terminated);
    }
}

/// How a checkpoint describes an unfinished episode.
const BETWEEN_EPISODES: u8 = 0;
const IN_EPISODE: u8 = 1;
/// The task cannot restore the state of an episode: the run is resumed with the next one.
const ABANDONED: u8 = 2;

impl<T: Task, L: Learner<T::Active>, R: Persist> Trainer<T, L, R> {
    /// Saves or restores the run, except for its tables and its finished episodes. A checkpoint is restored into a new run
    /// of the same task, learner and seed; how many actions there are must be known.
    ///
    /// # Errors
    /// The bytes are damaged, or belong to another run. The run is then useless.
    pub fn persist(&mut self, num_actions: usize, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.rng.persist(checkpoint)?;
        self.learner.persist(checkpoint)?;
        let mut progress = match self.episode {
            None => BETWEEN_EPISODES,
            Some(_) if self.task.resumes_episodes() => IN_EPISODE,
            Some(_) => ABANDONED,
        };
        progress.persist(checkpoint)?;
        match progress {
            IN_EPISODE => return self.persist_episode(num_actions, checkpoint),
            ABANDONED if checkpoint.is_restoring() => self.learner.abandon_episode(),
            BETWEEN_EPISODES | ABANDONED => {}
            _ => return Err(CheckpointError::Invalid("progress of an episode")),
        }
        self.task.persist(None, checkpoint)
    }

    fn persist_episode(&mut self, num_actions: usize, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        const INVALID: CheckpointError = CheckpointError::Invalid("state of the environment");
        let mut episode = match &self.episode {
            Some(episode) => *episode,
            None => {
                // Any state will do, and the generator is restored after it.
                let (state, active) = self.task.reset().map_err(|_| INVALID)?;
                EpisodeState { state, active, action: 0, episode_return: 0.0, length: 0 }
            }
        };
        self.task.persist(Some(&mut episode.state), checkpoint)?;
        checkpoint.index(&mut episode.action, num_actions, "action")?;
        (&mut episode.episode_return, &mut episode.length).persist(checkpoint)?;
        if checkpoint.is_restoring() {
            episode.active = self.task.active_rows(&episode.state).map_err(|_| INVALID)?;
        }
        self.episode = Some(episode);
        Ok(())
    }

    /// Continues a run that has finished these episodes and learned these tables: the schedules move on to the episode
    /// after them. The rest of the run is restored by `persist`.
    ///
    /// # Errors
    /// The number of tables, or of their values, is another.
    pub fn resume(&mut self, episodes: EpisodeLog, tables: &[&[f64]]) -> Result<(), CheckpointError> {
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
