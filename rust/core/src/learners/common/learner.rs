//! The trait of all learners.

use crate::checkpoint::{Checkpoint, CheckpointError, RunIdentity};
use crate::memory::{AllocationError, RunMemory};
use crate::random::Rng;
use crate::tasks::Next;

/// A learner, which owns its table, its policy and its schedules. A state is given by its active rows `R`. Each learner
/// draws from the agent's generator in the order of its Python reference.
pub trait Learner<R> {
    /// Whether the trainer's loop is worth compiling for wide vector registers too, because a step passes over many
    /// values.
    const HAS_VECTOR_PASSES: bool = false;

    /// Samples the first action of an episode.
    fn first_action(&mut self, state: R, rng: &mut impl Rng) -> usize;

    /// Learns from one step and returns the next action. The result is ignored at the end of an episode.
    fn learn(&mut self, state: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize;

    /// [`learn`](Self::learn) with borrowed active rows, which then are not copied. The trainer calls it for weighted
    /// features, of which each state has hundreds of bytes.
    #[inline(always)]
    fn learn_borrowed(&mut self, state: &R, action: usize, reward: f64, next: Next<&R>, rng: &mut impl Rng) -> usize
    where
        R: Copy,
    {
        self.learn(*state, action, reward, next.copied(), rng)
    }

    /// Records the action mask of a state, as reported by the task, before an action is chosen in this state or learned
    /// from.
    #[inline]
    fn set_action_mask(&mut self, _state: R, _mask: &[bool]) {}

    /// The action masks, row by row; `None` if every action is available in every state.
    fn action_masks(&self) -> Option<&[bool]> {
        None
    }

    /// The work of the last step, as [`Budget`](crate::Budget) counts it. At least 1.
    #[inline]
    fn work(&self) -> u64 {
        1
    }

    /// Makes room for everything that this much work can store.
    ///
    /// # Errors
    /// `OutOfMemory`, `LimitReached`.
    fn reserve(&mut self, _work: u64, _memory: &mut RunMemory) -> Result<(), AllocationError> {
        Ok(())
    }

    /// Whether the last step is unfinished, because its work exceeds that of one call. The trainer then calls
    /// [`resume`](Self::resume) before anything else.
    #[inline]
    fn is_unfinished(&self) -> bool {
        false
    }

    /// Continues to learn from the last step, which led to `next`, and returns the next action once the step is
    /// finished.
    fn resume(&mut self, _next: Next<R>, _rng: &mut impl Rng) -> usize {
        0
    }

    /// The number of updates made from a model; `None` if they are not counted.
    fn planning_updates(&self) -> Option<u64> {
        None
    }

    /// The estimate of the average reward; `None` if the learner does not estimate it.
    fn average_reward(&self) -> Option<f64> {
        None
    }

    /// Called after the last step of every episode.
    fn end_episode(&mut self);

    /// Writes back into the tables the values that the learner stores elsewhere while it learns. The trainer calls it
    /// after the last step of a call.
    fn complete_tables(&mut self) {}

    /// The values of the tables, row by row.
    fn tables(&self) -> Vec<&[f64]>;

    /// The tables of which the greedy policy maximizes the sum: all but that of a critic.
    fn policy_tables(&self) -> Vec<&[f64]> {
        self.tables()
    }

    /// The values of the tables, mutable, so that a resumed run can replace them.
    fn tables_mut(&mut self) -> Vec<&mut [f64]>;

    /// The number of rows and actions of each table.
    fn shape(&self) -> (usize, usize);

    /// Moves the schedules on by this many episodes without learning.
    fn skip_episodes(&mut self, episodes: usize) {
        (0..episodes).for_each(|_| self.end_episode());
    }

    /// Abandons an unfinished episode, so that another one can begin.
    fn abandon_episode(&mut self);

    /// Adds what the learner is made of, so that a checkpoint of another learner is refused: by default its type.
    fn identify(&self, identity: &mut RunIdentity) {
        identity.add_type::<Self>("learner");
    }

    /// Saves or restores everything that has changed since the start of the run, except for the tables and the
    /// schedules.
    ///
    /// # Errors
    /// The bytes are damaged, or belong to another run.
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError>;

    /// Whether a value has overflowed, so that further training is meaningless.
    fn diverged(&self) -> bool;
}
