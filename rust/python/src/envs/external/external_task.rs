//! An environment of another library as a learner's task.

use std::marker::PhantomData;
use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::checkpoint::{Checkpoint, CheckpointError, Persist};
use qtab_core::memory::{AllocationError, collect, out_of_memory, with_capacity};
use qtab_core::prediction::ObservableTask;
use qtab_core::random::Pcg64;
use qtab_core::tasks::{NextKind, RngSnapshot, Transition};
use qtab_core::{Features, Task};
use qtab_env::Number;
use qtab_env::host::{Ending, Episode, RandomBits};

use super::external_env::{EnvironmentBits, ExternalEnv, Position, SharedEnv};
use super::repeated_episode::{EPISODE_SO_FAR, EpisodeSoFar};
use crate::convert::Seed;
use crate::error::{RunError, allocation};
use crate::rng::environment_rng;

/// The time limit of a task, and whether the learner uses the action masks of the environment.
#[derive(Clone, Copy)]
pub(super) struct TaskOptions {
    pub(super) max_episode_steps: u64,
    pub(super) has_masks: bool,
}

/// An environment with features of its observations, which are numbers of type `T`, its time limit and its generator.
pub(super) struct ExternalTask<T, F> {
    pub(super) episode: Episode<SharedEnv>,
    features: F,
    pub(super) max_episode_steps: u64,
    pub(super) bits: EnvironmentBits<Pcg64>,
    pub(super) seed: Seed,
    /// The actions available in the last state that is not terminal; `None` if the learner does not use action masks.
    mask: Option<Vec<bool>>,
    /// The episode so far, for an environment that repeats it in Python where a step fails; `None` if it is not known.
    pub(super) played: Option<EpisodeSoFar>,
    /// A function of an action, which takes the next step in Python, after a step that failed.
    pub(super) next_step: Option<Py<PyAny>>,
    numbers: PhantomData<T>,
}

impl<T: Number, F: Features<[T]>> ExternalTask<T, F> {
    pub(super) fn new(env: &Arc<ExternalEnv>, features: F, options: TaskOptions, seed: &Seed) -> PyResult<Self> {
        let environment = &env.environment;
        let numbers = environment.state_size() + environment.observation_size() * size_of::<T>();
        let episode = Episode::new(SharedEnv(Arc::clone(env)));
        let mut mask = None;
        if options.has_masks {
            let mut available = with_capacity(environment.num_actions()).map_err(allocation)?;
            available.resize(environment.num_actions(), true);
            mask = Some(available);
        }
        Ok(Self {
            episode: episode.map_err(|error| allocation(out_of_memory::<u8>(numbers)(error)))?,
            features,
            max_episode_steps: options.max_episode_steps,
            bits: EnvironmentBits(environment_rng(seed)),
            seed: seed.clone(),
            mask,
            played: None,
            next_step: None,
            numbers: PhantomData,
        })
    }

    /// The numbers of the observation.
    pub(super) fn numbers(&self) -> Result<Vec<f64>, AllocationError> {
        collect(self.episode.observation::<T>().iter().map(|number| number.to_f64()))
    }

    /// The number of words that the generator has drawn, and its buffered half-word.
    #[inline]
    pub(super) fn position(&self) -> Position {
        (self.bits.0.words_drawn(), self.bits.0.buffered_u32())
    }

    /// Reads the action mask of a state that is not terminal.
    #[inline]
    pub(super) fn read_mask(&mut self) -> Result<(), RunError> {
        let Some(mask) = &mut self.mask else { return Ok(()) };
        let given = self.episode.action_mask();
        let mut largest = 0;
        for (available, &byte) in mask.iter_mut().zip(given) {
            *available = byte == 1;
            largest = largest.max(byte);
        }
        if largest == 1 { Ok(()) } else { Err(invalid_mask(given)) }
    }

    /// The kind of the next state, given the `elapsed`th step of the episode.
    #[inline]
    fn next_kind(&self, ending: Ending, elapsed: u64) -> NextKind {
        match ending {
            Ending::Terminated => NextKind::Terminal,
            Ending::Truncated => NextKind::Truncated,
            Ending::Continues if elapsed >= self.max_episode_steps => NextKind::Truncated,
            Ending::Continues => NextKind::NonTerminal,
        }
    }

    /// Takes a step in the environment.
    #[expect(clippy::inline_always, reason = "as for `step`")]
    #[inline(always)]
    pub(super) fn take_step(&mut self, elapsed: &mut u64, action: usize) -> Result<(f64, NextKind), RunError> {
        let before = self.position();
        let (reward, ending) = if self.next_step.is_some() {
            self.step_in_python(action, before)?
        } else {
            match self.episode.step(action, &mut RandomBits::new(&mut self.bits)) {
                Ok(stepped) => stepped,
                Err(error) => self.repeat(error, before, Some(action))?,
            }
        };
        self.note(action)?;
        *elapsed += 1;
        Ok((reward, self.next_kind(ending, *elapsed)))
    }
}

/// Saves the bytes of the state, or reads the saved ones, and returns them.
pub(super) fn saved_state(
    episode: &Episode<SharedEnv>,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Vec<u8>, CheckpointError> {
    let mut size = episode.state().len() as u64;
    size.persist(checkpoint)?;
    saved_bytes(episode, size, checkpoint)
}

/// Saves the bytes of the state, of a number that was saved before, or reads the saved ones, and returns them.
fn saved_bytes(
    episode: &Episode<SharedEnv>,
    size: u64,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Vec<u8>, CheckpointError> {
    let state = episode.state();
    checkpoint.check(size == state.len() as u64, "size of the environment's state")?;
    let mut bytes = with_capacity(state.len()).map_err(|_| CheckpointError::OutOfMemory)?;
    bytes.extend_from_slice(state);
    bytes.as_mut_slice().persist(checkpoint)?;
    Ok(bytes)
}

#[cold]
fn invalid_mask(mask: &[u8]) -> RunError {
    let expected = "the environment must write an action mask of 0 and 1 with at least one 1";
    PyValueError::new_err(format!("{expected}, got {mask:?}")).into()
}

impl<T: Number, F: Features<[T]>> Task for ExternalTask<T, F> {
    /// The steps taken since the reset. The episode has the rest of the state.
    type State = u64;
    type Active = F::Active;
    type Error = RunError;

    fn reset(&mut self) -> Result<(u64, F::Active), RunError> {
        self.begin()?;
        let rows = self.features.active_rows(self.episode.observation())?;
        self.read_mask()?;
        Ok((0, rows))
    }

    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn step(&mut self, elapsed: &mut u64, action: usize) -> Result<Transition<F::Active>, RunError> {
        let (reward, next) = self.take_step(elapsed, action)?;
        let rows = self.features.active_rows(self.episode.observation())?;
        if next != NextKind::Terminal {
            self.read_mask()?;
        }
        Ok(Transition { reward, next: next.with_rows(rows) })
    }

    #[inline]
    fn step_into(
        &mut self,
        elapsed: &mut u64,
        action: usize,
        active: &mut F::Active,
    ) -> Result<(f64, NextKind), RunError> {
        let (reward, next) = self.take_step(elapsed, action)?;
        self.features.write_active_rows(self.episode.observation(), active)?;
        if next != NextKind::Terminal {
            self.read_mask()?;
        }
        Ok((reward, next))
    }

    fn action_mask(&self) -> Option<&[bool]> {
        self.mask.as_deref()
    }

    fn step_work(&self) -> u64 {
        self.episode.shared().0.step_work
    }

    fn active_rows(&self, _elapsed: &u64) -> Result<F::Active, RunError> {
        Ok(self.features.active_rows(self.episode.observation())?)
    }

    /// The generator and, within an episode, the bytes of the state, with its observation: if the environment gives
    /// another one for these bytes, its code has changed. For an environment that repeats episodes in Python, the actions
    /// so far; checkpoints of earlier versions have the bytes of the state there, too.
    fn persist(&mut self, state: Option<&mut u64>, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        const INVALID: CheckpointError = CheckpointError::Invalid("state of the environment");
        self.bits.0.persist(checkpoint)?;
        let Some(elapsed) = state else { return Ok(()) };
        let mut size = if self.played.is_some() { EPISODE_SO_FAR } else { self.episode.state().len() as u64 };
        size.persist(checkpoint)?;
        if size == EPISODE_SO_FAR && self.episode.shared().0.repeats_episodes {
            return self.persist_played(elapsed, checkpoint);
        }
        let bytes = saved_bytes(&self.episode, size, checkpoint)?;
        // A failed step may have written an observation. Without `observe` a run is saved, too.
        let _ = if checkpoint.is_restoring() { Ok(()) } else { self.episode.observe() };
        let mut saved = self.numbers().map_err(|_| CheckpointError::OutOfMemory)?;
        saved.as_mut_slice().persist(checkpoint)?;
        elapsed.persist(checkpoint)?;
        checkpoint.check(*elapsed <= self.max_episode_steps, "number of steps taken")?;
        if checkpoint.is_restoring() {
            self.episode.set_state(&bytes);
            self.episode.observe().map_err(|_| INVALID)?;
            let observed = self.numbers().map_err(|_| CheckpointError::OutOfMemory)?;
            checkpoint.check(observed == saved, "observation of the state")?;
            self.played = None;
            // A terminal state may have no available action, and `step` or `reset` writes the mask before it is used.
            let _ = self.read_mask();
        }
        Ok(())
    }
}

/// The snapshot is the number of 64-bit words drawn since seeding, and the buffered 32-bit half.
impl<T: Number, F: Features<[T]>> RngSnapshot for ExternalTask<T, F> {
    type Snapshot = (u64, Option<u32>);

    fn rng_snapshot(&self) -> Result<Self::Snapshot, RunError> {
        Ok(self.position())
    }
}

/// The observation is a copy, as a policy may be a Python function that keeps it.
impl<T: Number, F: Features<[T]>> ObservableTask for ExternalTask<T, F> {
    type Observation = Vec<T>;

    fn observation(&self, _elapsed: &u64) -> Vec<T> {
        self.episode.observation().to_vec()
    }
}
