//! The trait of all update rules.

use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::memory::{AllocationError, RunMemory};
use crate::q_table::QTable;
use crate::random::Rng;
use crate::tasks::Next;

/// The update rule of an algorithm for an agent `G`: its equation, and the data that it stores between steps.
pub trait UpdateRule<R, G> {
    /// As [`Learner::HAS_VECTOR_PASSES`](super::Learner::HAS_VECTOR_PASSES).
    const HAS_VECTOR_PASSES: bool = false;

    /// Whether the second table holds the values of a critic, which the policy does not read.
    const HAS_CRITIC: bool = false;

    /// Samples the first action of an episode; `None` leaves the choice to the policy.
    #[inline]
    fn first_action(&mut self, _agent: &mut G, _state: R, _rng: &mut impl Rng) -> Option<usize> {
        None
    }

    /// Learns from one step and returns the next action, as [`Learner::learn`](super::Learner::learn).
    fn learn(
        &mut self,
        agent: &mut G,
        state: R,
        action: usize,
        reward: f64,
        next: Next<R>,
        rng: &mut impl Rng,
    ) -> usize;

    /// As [`Learner::learn_borrowed`](super::Learner::learn_borrowed). Rules that store no active rows implement it with
    /// the macro `learn_borrowed`.
    #[inline(always)]
    fn learn_borrowed(
        &mut self,
        agent: &mut G,
        state: &R,
        action: usize,
        reward: f64,
        next: Next<&R>,
        rng: &mut impl Rng,
    ) -> usize
    where
        R: Copy,
    {
        self.learn(agent, *state, action, reward, next.copied(), rng)
    }

    /// As [`Learner::work`](super::Learner::work), given the work of updating a row: that alone for a one-step method.
    #[inline]
    fn work(&self, row_work: u64) -> u64 {
        row_work
    }

    /// As [`Learner::reserve`](super::Learner::reserve).
    ///
    /// # Errors
    /// `OutOfMemory`, `LimitReached`.
    fn reserve(&mut self, _agent: &mut G, _work: u64, _memory: &mut RunMemory) -> Result<(), AllocationError> {
        Ok(())
    }

    /// As [`Learner::is_unfinished`](super::Learner::is_unfinished).
    #[inline]
    fn is_unfinished(&self) -> bool {
        false
    }

    /// As [`Learner::resume`](super::Learner::resume).
    fn resume(&mut self, _agent: &mut G, _next: Next<R>, _rng: &mut impl Rng) -> usize {
        0
    }

    /// As [`Learner::planning_updates`](super::Learner::planning_updates).
    fn planning_updates(&self) -> Option<u64> {
        None
    }

    /// The estimate of the average reward; `None` if the rule does not estimate it.
    fn average_reward(&self) -> Option<f64> {
        None
    }

    /// The second table, if the rule learns one besides the agent's.
    fn second_table(&self) -> Option<&QTable> {
        None
    }

    /// The second table, mutable, so that a resumed run can replace it.
    fn second_table_mut(&mut self) -> Option<&mut QTable> {
        None
    }

    /// Called after the last step of every episode. The rule discards its data of the episode.
    fn end_episode(&mut self, _agent: &mut G) {}

    /// Called when an episode is abandoned before its end.
    fn abandon_episode(&mut self, agent: &mut G) {
        self.end_episode(agent);
    }

    /// As [`Learner::complete_tables`](super::Learner::complete_tables).
    fn complete_tables(&mut self, _agent: &mut G) {}

    /// Saves or restores the data stored between steps. `shape` is the number of rows and of actions of the table.
    ///
    /// # Errors
    /// The bytes are damaged, or belong to another run.
    fn persist(&mut self, _shape: (usize, usize), _checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        Ok(())
    }
}

/// Implements [`UpdateRule::learn_borrowed`] for an agent of this type by a rule that learns with any active rows: references
/// to active rows are active rows, too.
macro_rules! learn_borrowed {
    ($agent:ty) => {
        #[inline(always)]
        fn learn_borrowed(
            &mut self,
            agent: &mut $agent,
            state: &R,
            action: usize,
            reward: f64,
            next: Next<&R>,
            rng: &mut impl Rng,
        ) -> usize {
            UpdateRule::<&R, $agent>::learn(self, agent, state, action, reward, next, rng)
        }
    };
}

pub(crate) use learn_borrowed;
