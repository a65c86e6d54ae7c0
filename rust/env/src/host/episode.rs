//! The memory of an episode, and the calls of the functions on it.

#![expect(unsafe_code, reason = "the functions are in C")]

use std::collections::TryReserveError;
use std::mem::swap;
use std::ops::Deref;
use std::ptr;

use super::buffer::Buffer;
use super::{CallError, Environment, RandomBits};
use crate::Number;
use crate::table::{CONTINUES, FAILED, TERMINATED, TRUNCATED};

const BOTH: i32 = TERMINATED | TRUNCATED;

/// Whether an episode continues after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It continues.
    Continues,
    /// It was cut off in a state that is not terminal.
    Truncated,
    /// The next state is terminal.
    Terminated,
}

/// An episode of an environment: its state, and the last observation and action mask. `E` is a reference to the
/// [`Environment`] in any form.
#[derive(Debug)]
pub struct Episode<E> {
    environment: E,
    state: Buffer,
    next_state: Buffer,
    observation: Buffer,
    action_mask: Buffer,
}

impl<E: Deref<Target = Environment>> Episode<E> {
    /// Memory for the episodes of an environment. [`reset`](Self::reset) begins one.
    ///
    /// # Errors
    /// The memory does not suffice.
    pub fn new(environment: E) -> Result<Self, TryReserveError> {
        let number_size = if environment.observation_type() == f32::TYPE { size_of::<f32>() } else { size_of::<f64>() };
        let state_size = environment.state_size();
        Ok(Self {
            state: Buffer::new(state_size)?,
            next_state: Buffer::new(state_size)?,
            observation: Buffer::new(environment.observation_size() * number_size)?,
            action_mask: Buffer::new(environment.num_actions())?,
            environment,
        })
    }

    /// The environment.
    pub fn environment(&self) -> &Environment {
        &self.environment
    }

    /// The reference to the environment that the episode was made with.
    pub fn shared(&self) -> &E {
        &self.environment
    }

    /// Begins an episode.
    ///
    /// # Errors
    /// The function failed, and the state is as before.
    pub fn reset(&mut self, random: &mut RandomBits<'_>) -> Result<(), CallError> {
        let environment = &*self.environment;
        // SAFETY: the buffers have the sizes of the table, whose functions keep to them, as `Environment::new` requires.
        let code = unsafe {
            (environment.reset)(
                environment.table.parameters,
                ptr::from_ref(&random.bitgen),
                self.next_state.address(),
                self.observation.address(),
                self.action_mask.address().cast(),
            )
        };
        only_continues("reset", code)?;
        swap(&mut self.state, &mut self.next_state);
        Ok(())
    }

    /// Takes a step. Returns the reward.
    ///
    /// # Errors
    /// The function failed, and the state is as before.
    ///
    /// # Panics
    /// If there is no such action.
    #[inline]
    pub fn step(&mut self, action: usize, random: &mut RandomBits<'_>) -> Result<(f64, Ending), CallError> {
        let (reward, code) = self.call_step(action, random)?;
        let ending = match code {
            CONTINUES => Ending::Continues,
            TRUNCATED => Ending::Truncated,
            _ => Ending::Terminated,
        };
        Ok((reward, ending))
    }

    /// Takes a step, as [`step`](Self::step) does. Returns the reward, whether the next state is terminal, and whether
    /// the episode was cut off; the function may return both.
    ///
    /// # Errors
    /// As for [`step`](Self::step).
    ///
    /// # Panics
    /// As for [`step`](Self::step).
    pub fn step_flags(&mut self, action: usize, random: &mut RandomBits<'_>) -> Result<(f64, bool, bool), CallError> {
        let (reward, code) = self.call_step(action, random)?;
        Ok((reward, code & TERMINATED != 0, code & TRUNCATED != 0))
    }

    #[inline]
    fn call_step(&mut self, action: usize, random: &mut RandomBits<'_>) -> Result<(f64, i32), CallError> {
        let environment = &*self.environment;
        assert!(action < environment.num_actions(), "an action must be less than num_actions");
        let mut reward = f64::NAN;
        // SAFETY: as in `reset`, and the state was written by `reset`, `step` or `set_state`.
        let code = unsafe {
            (environment.step)(
                environment.table.parameters,
                ptr::from_ref(&random.bitgen),
                self.state.address(),
                (action as u64).cast_signed(),
                self.next_state.address(),
                self.observation.address(),
                &raw mut reward,
                self.action_mask.address().cast(),
            )
        };
        if !matches!(code, CONTINUES | TERMINATED | TRUNCATED | BOTH) {
            return Err(failure("step", code));
        }
        if !reward.is_finite() {
            return Err(CallError::Reward(reward));
        }
        swap(&mut self.state, &mut self.next_state);
        Ok((reward, code))
    }

    /// Writes the observation and the action mask of the state again.
    ///
    /// # Errors
    /// The function failed.
    pub fn observe(&mut self) -> Result<(), CallError> {
        let environment = &*self.environment;
        // SAFETY: as in `step`.
        let code = unsafe {
            (environment.observe)(
                environment.table.parameters,
                self.state.address(),
                self.observation.address(),
                self.action_mask.address().cast(),
            )
        };
        only_continues("observe", code)
    }

    /// The bytes of the state.
    pub fn state(&self) -> &[u8] {
        self.state.bytes()
    }

    /// Replaces the state. Call [`observe`](Self::observe) afterwards. The bytes must be those of a state of this
    /// environment, as [`Environment::new`] requires.
    ///
    /// # Panics
    /// If the number of bytes differs.
    pub fn set_state(&mut self, state: &[u8]) {
        self.state.bytes_mut().copy_from_slice(state);
    }

    /// Replaces the observation, given as bytes, and the action mask, as a step writes them that is taken elsewhere.
    ///
    /// # Panics
    /// If a number of bytes differs.
    pub fn set_observation(&mut self, observation: &[u8], action_mask: &[u8]) {
        self.observation.bytes_mut().copy_from_slice(observation);
        self.action_mask.bytes_mut().copy_from_slice(action_mask);
    }

    /// The last observation; empty if its numbers are of another type.
    #[inline]
    pub fn observation<T: Number>(&self) -> &[T] {
        if self.environment.observation_type() == T::TYPE { self.observation.numbers() } else { &[] }
    }

    /// The last action mask, a byte for each action: 1 if it is available, and 0 if not.
    #[inline]
    pub fn action_mask(&self) -> &[u8] {
        self.action_mask.bytes()
    }

    /// The bytes of the state before the last step.
    pub(super) fn previous_state(&self) -> &[u8] {
        self.next_state.bytes()
    }

    /// The name of a buffer beyond whose end a function has written.
    pub(super) fn overrun(&self) -> Option<&'static str> {
        let buffers = [
            ("state", &self.state),
            ("next_state", &self.next_state),
            ("observation", &self.observation),
            ("action_mask", &self.action_mask),
        ];
        buffers.iter().find(|(_, buffer)| !buffer.is_intact()).map(|&(name, _)| name)
    }
}

fn only_continues(function: &'static str, code: i32) -> Result<(), CallError> {
    if code == CONTINUES { Ok(()) } else { Err(failure(function, code)) }
}

#[cold]
fn failure(function: &'static str, code: i32) -> CallError {
    if code == FAILED { CallError::Failed } else { CallError::Code { function, code } }
}
