//! One of several sub-environments of another library.

use pyo3::prelude::*;
use qtab_core::checkpoint::{Checkpoint, CheckpointError, Persist};
use qtab_core::memory::{AllocationError, out_of_memory, reserve, with_capacity};
use qtab_core::random::Pcg64;
use qtab_env::host::{CallError, Episode, RandomBits};

use super::external_env::{EnvironmentBits, FailedCall, Position, SharedEnv};
use super::external_task::saved_state;
use super::repeated_episode::EpisodeSoFar;
use crate::convert::Seed;

/// The episode of a sub-environment, and the results of its last step.
pub(super) struct SubEnv {
    pub(super) episode: Episode<SharedEnv>,
    pub(super) progress: Progress,
    pub(super) reward: f64,
    pub(super) terminated: bool,
    pub(super) truncated: bool,
    /// The state, the progress and the generator before the present call.
    before: (Vec<u8>, Progress, Option<Pcg64>),
    /// The episode so far, for an environment that repeats it in Python where a call fails.
    pub(super) played: Option<CurrentEpisode>,
    failed: Option<Failed>,
}

/// How far an episode is.
#[derive(Clone, Copy, Default)]
pub(super) struct Progress {
    /// Whether there is a state: a reset has succeeded.
    has_state: bool,
    /// The steps since the reset.
    pub(super) elapsed: u64,
    /// Whether the episode has ended and was not reset yet.
    pub(super) done: bool,
}

/// The episode so far, and what the present call has changed of it.
#[derive(Default)]
pub(super) struct CurrentEpisode {
    pub(super) now: EpisodeSoFar,
    /// The episode that a reset in the present call has ended.
    ended: EpisodeSoFar,
    was_reset: bool,
    /// The number of actions before the present call.
    actions_before: usize,
}

impl CurrentEpisode {
    fn begin_call(&mut self) {
        (self.was_reset, self.actions_before) = (false, self.now.actions.len());
    }

    /// Begins an episode with the generator at `start`.
    fn reset(&mut self, start: Position) {
        std::mem::swap(&mut self.now, &mut self.ended);
        self.was_reset = true;
        self.now.start = start;
        self.now.actions.clear();
    }

    fn undo(&mut self) {
        if self.was_reset {
            std::mem::swap(&mut self.now, &mut self.ended);
            self.was_reset = false;
        }
        self.now.actions.truncate(self.actions_before);
    }
}

/// A function that failed: the position of the generator before the call, and the action of a step.
struct Failed {
    error: CallError,
    position: Position,
    action: Option<usize>,
}

impl SubEnv {
    pub(super) fn new(env: &SharedEnv) -> Result<Self, AllocationError> {
        let state_size = env.state_size();
        Ok(Self {
            episode: Episode::new(env.clone()).map_err(out_of_memory::<u8>(state_size))?,
            progress: Progress::default(),
            reward: 0.0,
            terminated: false,
            truncated: false,
            before: (with_capacity(state_size)?, Progress::default(), None),
            played: env.0.repeats_episodes.then(CurrentEpisode::default),
            failed: None,
        })
    }

    /// Makes room for the action of a step.
    pub(super) fn reserve_action(&mut self) -> Result<(), AllocationError> {
        self.played.as_mut().map_or(Ok(()), |played| reserve(&mut played.now.actions, 1))
    }

    /// Keeps what `undo` restores.
    pub(super) fn begin_call(&mut self, rng: &Pcg64) {
        if let Some(played) = &mut self.played {
            played.begin_call();
        }
        let (state, progress, generator) = &mut self.before;
        state.clear();
        state.extend_from_slice(self.episode.state());
        (*progress, *generator) = (self.progress, Some(rng.clone()));
    }

    /// Returns to the state, the observation and the generator before the call.
    pub(super) fn undo(&mut self, rng: &mut Pcg64) {
        let (state, progress, Some(generator)) = &mut self.before else { return };
        rng.clone_from(generator);
        self.progress = *progress;
        self.failed = None;
        if let Some(played) = &mut self.played {
            played.undo();
        }
        if progress.has_state {
            self.episode.set_state(state);
            // It has written the observation of this state before, and does so again.
            let _ = self.episode.observe();
        }
    }

    /// Begins an episode. The results of the last step stay.
    pub(super) fn reset(&mut self, rng: &mut Pcg64) {
        let position = (rng.words_drawn(), rng.buffered_u32());
        match self.episode.reset(&mut RandomBits::new(&mut EnvironmentBits(rng))) {
            Ok(()) => {
                self.progress = Progress { has_state: true, elapsed: 0, done: false };
                if let Some(played) = &mut self.played {
                    played.reset(position);
                }
            }
            Err(error) => self.failed = Some(Failed { error, position, action: None }),
        }
    }

    /// Takes a step, for which `reserve_action` has made room.
    ///
    /// The time limit of the library does not truncate an episode whose next state is terminal; `limit` also does.
    pub(super) fn step(&mut self, action: usize, limit: u64, rng: &mut Pcg64) {
        let position = (rng.words_drawn(), rng.buffered_u32());
        let library_limit = self.episode.environment().max_episode_steps().unwrap_or(u64::MAX);
        match self.episode.step_flags(action, &mut RandomBits::new(&mut EnvironmentBits(rng))) {
            Ok((reward, terminated, truncated)) => {
                let elapsed = self.progress.elapsed + 1;
                // A library's sum of both counts as terminated; a class returns both.
                let is_cut = (truncated || elapsed >= library_limit) && (!terminated || self.played.is_some());
                self.reward = reward;
                self.terminated = terminated;
                self.truncated = is_cut || elapsed >= limit;
                self.progress.elapsed = elapsed;
                self.progress.done = self.terminated || self.truncated;
                if let Some(played) = &mut self.played {
                    played.now.actions.push(action as u32);
                }
            }
            Err(error) => self.failed = Some(Failed { error, position, action: Some(action) }),
        }
    }

    /// The error of the call if it failed, for a generator that was seeded with `seed`.
    pub(super) fn error(&self, py: Python<'_>, seed: &Seed) -> Option<PyErr> {
        let Failed { error, position, action } = self.failed.as_ref()?;
        let state = action.map(|_| self.episode.state());
        let played = self.played.as_ref().map(|played| (played.now.start, played.now.actions.as_slice()));
        let failed = FailedCall { state, before: *position, action: *action, seed, played };
        Some(self.episode.shared().0.error(py, *error, &failed))
    }

    /// Saves the episode, or restores the saved one with its observation.
    pub(super) fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let Progress { has_state, elapsed, done } = &mut self.progress;
        (has_state, elapsed, done).persist(checkpoint)?;
        let state = saved_state(&self.episode, checkpoint)?;
        if checkpoint.is_restoring() && self.progress.has_state {
            self.episode.set_state(&state);
            self.episode.observe().map_err(|_| CheckpointError::Invalid("state of the environment"))?;
        }
        let num_actions = self.episode.environment().num_actions();
        let Some(CurrentEpisode { now, .. }) = &mut self.played else { return Ok(()) };
        now.start.persist(checkpoint)?;
        checkpoint.values(&mut now.actions)?;
        let is_valid = now.actions.iter().all(|&action| (action as usize) < num_actions);
        checkpoint.check(is_valid, "action")
    }
}
