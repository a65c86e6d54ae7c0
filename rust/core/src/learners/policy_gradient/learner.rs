//! A learner of a policy by its gradient, with or without a critic.

use super::Critic;
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::learners::{Agent, Learner};
use crate::memory::{AllocationError, RunMemory};
use crate::random::Rng;
use crate::tasks::Next;

/// The update rule of a policy gradient method. The agent's table holds the preferences θ, of which its policy is the
/// softmax.
pub trait PolicyGradientRule<R> {
    /// Learns from one step.
    fn learn(
        &mut self,
        agent: &mut Agent,
        critic: Option<&mut Critic>,
        state: R,
        action: usize,
        reward: f64,
        next: Next<R>,
    );

    /// As [`Learner::work`](crate::Learner::work).
    fn work(&self, agent: &Agent) -> u64;

    /// As [`Learner::reserve`](crate::Learner::reserve).
    ///
    /// # Errors
    /// `OutOfMemory`, `LimitReached`.
    fn reserve(&mut self, shape: (usize, usize), work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        let (_, _, _) = (shape, work, memory);
        Ok(())
    }

    /// Called after the last step of every episode, and where an episode is given up.
    fn end_episode(&mut self);

    /// Saves or restores what it stores between steps; `shape` is the number of rows and of actions of the table.
    ///
    /// # Errors
    /// The bytes are damaged, or belong to another run.
    fn persist(&mut self, shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError>;
}

/// An agent whose table holds preferences, a critic if the method has one, and the method's update rule.
#[derive(Clone, Debug, PartialEq)]
pub struct PolicyGradientLearner<U> {
    /// The preferences, the policy and the constants.
    pub agent: Agent,
    /// The state values.
    pub critic: Option<Critic>,
    /// The update rule.
    pub rule: U,
}

impl<R: Copy + AsRef<[u32]>, U: PolicyGradientRule<R>> Learner<R> for PolicyGradientLearner<U> {
    #[inline]
    fn first_action(&mut self, state: R, rng: &mut impl Rng) -> usize {
        self.agent.choose(state, rng)
    }

    #[inline]
    fn learn(&mut self, state: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize {
        self.rule.learn(&mut self.agent, self.critic.as_mut(), state, action, reward, next);
        self.agent.next_action(next, rng)
    }

    #[inline]
    fn set_action_mask(&mut self, state: R, mask: &[bool]) {
        self.agent.set_action_mask(state, mask);
    }

    fn action_masks(&self) -> Option<&[bool]> {
        self.agent.action_masks()
    }

    #[inline]
    fn work(&self) -> u64 {
        self.rule.work(&self.agent)
    }

    fn reserve(&mut self, work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        self.rule.reserve(self.agent.table.shape(), work, memory)
    }

    fn end_episode(&mut self) {
        self.rule.end_episode();
        self.agent.end_episode();
    }

    fn tables(&self) -> Vec<&[f64]> {
        let critic = self.critic.iter().map(|critic| critic.table.values());
        std::iter::once(self.agent.table.values()).chain(critic).collect()
    }

    fn tables_mut(&mut self) -> Vec<&mut [f64]> {
        let critic = self.critic.iter_mut().map(|critic| critic.table.values_mut());
        std::iter::once(self.agent.table.values_mut()).chain(critic).collect()
    }

    fn shape(&self) -> (usize, usize) {
        self.agent.table.shape()
    }

    fn skip_episodes(&mut self, episodes: usize) {
        (0..episodes).for_each(|_| self.agent.end_episode());
    }

    fn abandon_episode(&mut self) {
        self.rule.end_episode();
    }

    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.agent.persist_counts(checkpoint)?;
        self.rule.persist(self.agent.table.shape(), checkpoint)
    }

    fn diverged(&self) -> bool {
        self.agent.table.diverged()
    }
}
