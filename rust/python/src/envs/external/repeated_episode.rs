//! Episodes in which a call has failed: they are repeated in Python, and continued there.

use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use qtab_core::Features;
use qtab_core::checkpoint::{Checkpoint, CheckpointError, Persist};
use qtab_core::memory::reserve;
use qtab_env::host::{CallError, Ending, RandomBits};
use qtab_env::{CONTINUES, Number, TRUNCATED};

use super::external_env::{FailedCall, Position, Repeated};
use super::external_task::ExternalTask;
use crate::error::RunError;

/// In a checkpoint, the size of the state of an environment that repeats episodes: the episode so far follows instead.
pub(super) const EPISODE_SO_FAR: u64 = u64::MAX;

/// A repetition that was interrupted more often than this, perhaps by the environment itself, ends the run.
const MOST_INTERRUPTIONS: usize = 3;

/// An episode so far.
#[derive(Clone, Default)]
pub(super) struct EpisodeSoFar {
    /// The position of the generator before the reset.
    pub(super) start: Position,
    pub(super) actions: Vec<u32>,
}

impl<T: Number, F: Features<[T]>> ExternalTask<T, F> {
    /// Repeats a call that failed in Python. The generator is moved back to its position before the call. An interrupted
    /// repetition begins again, so that the run stops after it and the episode is not lost.
    #[cold]
    pub(super) fn repeat(
        &mut self,
        error: CallError,
        before: Position,
        action: Option<usize>,
    ) -> Result<(f64, Ending), RunError> {
        self.bits.0.move_to(before.0, before.1);
        let failed = FailedCall {
            state: action.map(|_| self.episode.state()),
            before,
            action,
            seed: &self.seed,
            played: self.played.as_ref().map(|played| (played.start, played.actions.as_slice())),
        };
        let env = &self.episode.shared().0;
        let (result, next_step) = Python::attach(|py| {
            let mut interruptions = 0;
            loop {
                match env.repeat(py, error, &failed) {
                    Err(raised)
                        if raised.is_instance_of::<PyKeyboardInterrupt>(py) && interruptions < MOST_INTERRUPTIONS =>
                    {
                        interruptions += 1;
                    }
                    Ok(repeated) if interruptions > 0 => return interrupt(py).map(|()| repeated),
                    repeated => return repeated,
                }
            }
        })?;
        self.next_step = Some(next_step);
        self.take_over(result)
    }

    /// Takes over the result of a call in Python.
    #[cold]
    fn take_over(&mut self, result: Repeated) -> Result<(f64, Ending), RunError> {
        let (observation, mask, reward, code, (words_drawn, buffered_u32)) = result;
        self.bits.0.move_to(words_drawn, buffered_u32);
        self.episode.set_observation(&observation, &mask);
        if !reward.is_finite() {
            return Err(PyValueError::new_err(CallError::Reward(reward).to_string()).into());
        }
        let ending = match code {
            CONTINUES => Ending::Continues,
            TRUNCATED => Ending::Truncated,
            _ => Ending::Terminated,
        };
        Ok((reward, ending))
    }

    /// Takes a step in Python, in an episode in which an earlier call failed. An interrupted step is taken again, so that
    /// the run stops after it.
    #[cold]
    pub(super) fn step_in_python(&mut self, action: usize, before: Position) -> Result<(f64, Ending), RunError> {
        let result = Python::attach(|py| -> PyResult<Option<Repeated>> {
            let Some(step) = &self.next_step else { return Ok(None) };
            match step.call1(py, (action,)) {
                Err(error) if error.is_instance_of::<PyKeyboardInterrupt>(py) => Ok(None),
                result => result?.extract(py).map(Some),
            }
        })?;
        if let Some(result) = result {
            return self.take_over(result);
        }
        let stepped = self.repeat(CallError::Failed, before, Some(action))?;
        Python::attach(interrupt)?;
        Ok(stepped)
    }

    /// Begins an episode.
    pub(super) fn begin(&mut self) -> Result<(), RunError> {
        let before = self.position();
        self.next_step = None;
        if self.episode.shared().0.repeats_episodes {
            let played = self.played.get_or_insert_default();
            played.start = before;
            played.actions.clear();
        }
        if let Err(error) = self.episode.reset(&mut RandomBits::new(&mut self.bits)) {
            self.repeat(error, before, None)?;
        }
        Ok(())
    }

    /// Plays a saved episode again, up to the position of the generator at which it was saved.
    fn play_again(&mut self, saved: &EpisodeSoFar) -> Result<(), RunError> {
        let (words_drawn, buffered_u32) = saved.start;
        self.bits.0.move_to(words_drawn, buffered_u32);
        self.begin()?;
        let mut elapsed = 0;
        for &action in &saved.actions {
            self.take_step(&mut elapsed, action as usize)?;
        }
        Ok(())
    }

    /// Saves the actions of the episode so far, or restores the episode by taking them again. The last observation shows
    /// whether the code of the environment has changed.
    pub(super) fn persist_played(
        &mut self,
        elapsed: &mut u64,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        let is_saving = !checkpoint.is_restoring();
        if is_saving && self.next_step.is_none() {
            let _ = self.episode.observe();
        }
        let mut saved = self.played.clone().filter(|_| is_saving).unwrap_or_default();
        let mut observed = self.numbers().map_err(|_| CheckpointError::OutOfMemory)?;
        saved.start.persist(checkpoint)?;
        checkpoint.values(&mut saved.actions)?;
        observed.as_mut_slice().persist(checkpoint)?;
        elapsed.persist(checkpoint)?;
        let num_actions = self.episode.environment().num_actions();
        let is_valid = saved.actions.iter().all(|&action| (action as usize) < num_actions);
        checkpoint.check(is_valid, "action")?;
        let is_in_time = *elapsed <= self.max_episode_steps && *elapsed == saved.actions.len() as u64;
        checkpoint.check(is_in_time, "number of steps taken")?;
        if !is_saving {
            const INVALID: CheckpointError = CheckpointError::Invalid("state of the environment");
            let position = self.position();
            self.play_again(&saved).map_err(|_| INVALID)?;
            checkpoint.check(self.position() == position, "position of the environment's generator")?;
            let again = self.numbers().map_err(|_| CheckpointError::OutOfMemory)?;
            checkpoint.check(again == observed, "observation of the state")?;
            // A terminal state may have no available action, and `step` or `reset` writes the mask before it is used.
            let _ = self.read_mask();
        }
        Ok(())
    }

    /// Notes the action of a step, for an environment that repeats episodes.
    #[inline]
    pub(super) fn note(&mut self, action: usize) -> Result<(), RunError> {
        let Some(played) = &mut self.played else { return Ok(()) };
        if played.actions.len() == played.actions.capacity() {
            reserve(&mut played.actions, 1).map_err(RunError::Allocation)?;
        }
        played.actions.push(action as u32);
        Ok(())
    }
}

/// Interrupts the main thread of Python, as Ctrl-C does.
fn interrupt(py: Python<'_>) -> PyResult<()> {
    py.import("_thread")?.call_method0("interrupt_main").map(drop)
}
