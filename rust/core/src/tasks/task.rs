//! The trait of all tasks.

use crate::checkpoint::{Checkpoint, CheckpointError, RunIdentity};
use crate::features::ActiveRows;

/// The next state, as an update needs it. `R` holds its active rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next<R> {
    /// The episode continues.
    NonTerminal(R),
    /// The episode was cut off by its time limit. The next state is not terminal, so an update bootstraps from it.
    Truncated(R),
    /// The next state is terminal, at the time limit or before it.
    Terminal,
}

impl<R: Copy> Next<&R> {
    /// The next state with a copy of its active rows.
    #[inline]
    pub fn copied(self) -> Next<R> {
        match self {
            Self::NonTerminal(rows) => Next::NonTerminal(*rows),
            Self::Truncated(rows) => Next::Truncated(*rows),
            Self::Terminal => Next::Terminal,
        }
    }
}

/// [`Next`] without the active rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NextKind {
    /// [`Next::NonTerminal`].
    NonTerminal,
    /// [`Next::Truncated`].
    Truncated,
    /// [`Next::Terminal`].
    Terminal,
}

impl NextKind {
    /// The kind of the state after the `elapsed`th step of an episode. Call this after computing the active rows: with
    /// tile coding, a branch before them takes a tenth of the time of learning.
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    pub fn after(terminated: bool, elapsed: u64, max_episode_steps: u64) -> Self {
        if terminated {
            Self::Terminal
        } else if elapsed >= max_episode_steps {
            Self::Truncated
        } else {
            Self::NonTerminal
        }
    }

    /// The [`Next`] of this kind, with these active rows of the next state.
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    pub fn with_rows<R>(self, active: R) -> Next<R> {
        match self {
            Self::NonTerminal => Next::NonTerminal(active),
            Self::Truncated => Next::Truncated(active),
            Self::Terminal => Next::Terminal,
        }
    }
}

/// The result of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<R> {
    /// The reward.
    pub reward: f64,
    /// The next state.
    pub next: Next<R>,
}

/// An environment with its features and its time limit, as a learner sees it: active rows out, the index of an action
/// in. It is fallible, because environments in Python are.
pub trait Task {
    /// The state of an episode. The caller keeps it and passes it to every step, so that it can stay in registers.
    type State: Copy;
    /// The active rows of an observation.
    type Active: ActiveRows;
    /// The error of a reset or a step.
    type Error;

    /// Whether a step is worth compiling for wide vector registers too. [`step`](Self::step) is then always inlined.
    const USES_VECTORS: bool = false;

    /// Begins an episode. Returns its first state and the active rows.
    ///
    /// # Errors
    /// An error of the environment, or an observation without a row.
    fn reset(&mut self) -> Result<(Self::State, Self::Active), Self::Error>;

    /// Takes one step.
    ///
    /// # Errors
    /// As for `reset`.
    fn step(&mut self, state: &mut Self::State, action: usize) -> Result<Transition<Self::Active>, Self::Error>;

    /// Like [`step`](Self::step), but writes the active rows, and returns the reward and the kind of the next state.
    /// The rows are unspecified after a terminal state.
    ///
    /// # Errors
    /// As for `reset`.
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn step_into(
        &mut self,
        state: &mut Self::State,
        action: usize,
        active: &mut Self::Active,
    ) -> Result<(f64, NextKind), Self::Error> {
        let Transition { reward, next } = self.step(state, action)?;
        let kind = match next {
            Next::NonTerminal(next_active) => {
                *active = next_active;
                NextKind::NonTerminal
            }
            Next::Truncated(next_active) => {
                *active = next_active;
                NextKind::Truncated
            }
            Next::Terminal => NextKind::Terminal,
        };
        Ok((reward, kind))
    }

    /// The work of a step in units of [`Budget`](crate::Budget), in addition to the learner's: 0 for the environments
    /// of this crate.
    #[inline]
    fn step_work(&self) -> u64 {
        0
    }

    /// The action mask of the last state that `reset` or `step` led to; `None` if every action is available in every
    /// state, or if the learner already knows the masks. Unspecified after a terminal state.
    #[inline]
    fn action_mask(&self) -> Option<&[bool]> {
        None
    }

    /// The number of times that each action was taken in each row, row by row; `None` if visits are not counted.
    fn visits(&self) -> Option<&[i64]> {
        None
    }

    /// The active rows of a state.
    ///
    /// # Errors
    /// An observation without a row.
    fn active_rows(&self, state: &Self::State) -> Result<Self::Active, Self::Error>;

    /// The number of rows and of actions that a learner must have for this task; `None` if the task does not know it.
    fn shape(&self) -> Option<(usize, usize)> {
        None
    }

    /// Whether an episode can be resumed in the middle.
    fn resumes_episodes(&self) -> bool {
        true
    }

    /// Adds what the task is made of, so that a checkpoint of another task is refused: by default its type.
    fn identify(&self, identity: &mut RunIdentity) {
        identity.add_type::<Self>("task");
    }

    /// Saves or restores the random generator and, during an episode, its state.
    ///
    /// # Errors
    /// The bytes are damaged.
    fn persist(
        &mut self,
        state: Option<&mut Self::State>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError>;
}

/// A task that reports the state of the environment's random generator, so that an episode can be replayed.
pub trait RngSnapshot: Task {
    /// The state of the generator that the reset and the steps draw from.
    type Snapshot;

    /// The state of the generator now.
    ///
    /// # Errors
    /// Any error that the environment raises.
    fn rng_snapshot(&self) -> Result<Self::Snapshot, Self::Error>;
}
