//! The trait of all learners.

use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::memory::{AllocationError, RunMemory};
use crate::random::Rng;
use crate::tasks::Next;

/// A learner, which owns its table, its policy and its schedules. A state is given by its active rows `R`. Each learner
/// draws from the agent's generator in the order of its Python reference.
pub trait Learner<R> {
    /// Whether the trainer's loop is worth compiling for wide vector registers too, because a step passes over many values.
    const HAS_VECTOR_PASSES: bool = false;

    /// Samples the first action of an episode.
    fn first_action(&mut self, state: R, rng: &mut impl Rng) -> usize;

    /// Learns from one step and returns the next action. The result is ignored at the end of an episode.
    fn learn(&mut self, state: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize;

    /// Takes over which actions a state has, before it chooses or learns from them. The task says which.
    #[inline]
    fn set_action_mask(&mut self, state: R, mask: &[bool]) {
        let (_, _) = (state, mask);
    }

    /// Which actions the states have, row by row; `None` if each has all of them.
    fn action_masks(&self) -> Option<&[bool]> {
        None
    }

    /// The work of the last step, as [`Budget`](crate::Budget) counts it. At least 1.
    #[inline]
    fn work(&self) -> u64 {
        1
    }

    /// Makes room for what so much work can store.
    ///
    /// # Errors
    /// `OutOfMemory`, `LimitReached`.
    fn reserve(&mut self, work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        let (_, _) = (work, memory);
        Ok(())
    }

    /// Whether the last step still has work to do, because it is more than a caller may have to wait for. The trainer
    /// then calls [`resume`](Self::resume) before anything else.
    #[inline]
    fn is_unfinished(&self) -> bool {
        false
    }

    /// Continues to learn from the last step, which led to `next`, and returns the next action once the step is finished.
    fn resume(&mut self, next: Next<R>, rng: &mut impl Rng) -> usize {
        let (_, _) = (next, rng);
        0
    }

    /// How many updates were made from a model; `None` where that is not counted.
    fn planning_updates(&self) -> Option<u64> {
        None
    }

    /// The estimate of the average reward; `None` where none is learned.
    fn average_reward(&self) -> Option<f64> {
        None
    }

    /// Called after the last step of every episode.
    fn end_episode(&mut self);

    /// Writes into the tables what it keeps elsewhere while it learns. The trainer calls it after the last step of a call.
    fn complete_tables(&mut self) {}

    /// The values of its tables, row by row. The greedy policy is over their sum.
    fn tables(&self) -> Vec<&[f64]>;

    /// The same, to be replaced when a run is resumed.
    fn tables_mut(&mut self) -> Vec<&mut [f64]>;

    /// The number of rows and of actions of each table.
    fn shape(&self) -> (usize, usize);

    /// Moves the schedules on by this many episodes without learning.
    fn skip_episodes(&mut self, episodes: usize) {
        (0..episodes).for_each(|_| self.end_episode());
    }

    /// Gives up an unfinished episode, so that another one can begin.
    fn abandon_episode(&mut self);

    /// Saves or restores all that has changed since the start of the run, except for the tables and the schedules.
    ///
    /// # Errors
    /// The bytes are damaged, or belong to another run.
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError>;

    /// Whether a value has overflowed, so that further training is meaningless.
    fn diverged(&self) -> bool;
}
