//! A learner made of an agent and an update rule.

use super::{Agent, Learner, UpdateRule};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::features::ActiveFeatures;
use crate::memory::{AllocationError, RunMemory};
use crate::policies::Policy;
use crate::q_table::QTable;
use crate::random::Rng;
use crate::schedules::StepSize;
use crate::tasks::Next;

/// An agent with its update rule. The update rule is the algorithm; the rest is shared.
#[derive(Clone, Debug, PartialEq)]
pub struct TdLearner<U, G = Agent> {
    /// The table, the policy and the constants.
    pub agent: G,
    /// The update rule.
    pub rule: U,
}

impl<const N: usize, R, U, P, A> Learner<R> for TdLearner<U, Agent<N, P, A>>
where
    R: Copy + ActiveFeatures,
    U: UpdateRule<R, Agent<N, P, A>>,
    P: Policy,
    A: StepSize,
{
    const HAS_VECTOR_PASSES: bool = U::HAS_VECTOR_PASSES;

    #[inline]
    fn first_action(&mut self, state: R, rng: &mut impl Rng) -> usize {
        let chosen = self.rule.first_action(&mut self.agent, state, rng);
        chosen.unwrap_or_else(|| self.agent.choose(state, rng))
    }

    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn learn(&mut self, state: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize {
        self.rule.learn(&mut self.agent, state, action, reward, next, rng)
    }

    #[inline(always)]
    fn learn_borrowed(&mut self, state: &R, action: usize, reward: f64, next: Next<&R>, rng: &mut impl Rng) -> usize {
        self.rule.learn_borrowed(&mut self.agent, state, action, reward, next, rng)
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
        self.rule.work(self.agent.work_of::<R>())
    }

    fn reserve(&mut self, work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        self.rule.reserve(&mut self.agent, work, memory)
    }

    #[inline]
    fn is_unfinished(&self) -> bool {
        self.rule.is_unfinished()
    }

    fn resume(&mut self, next: Next<R>, rng: &mut impl Rng) -> usize {
        self.rule.resume(&mut self.agent, next, rng)
    }

    fn planning_updates(&self) -> Option<u64> {
        self.rule.planning_updates()
    }

    fn average_reward(&self) -> Option<f64> {
        self.rule.average_reward()
    }

    #[inline]
    fn end_episode(&mut self) {
        self.rule.end_episode(&mut self.agent);
        self.agent.end_episode();
    }

    fn complete_tables(&mut self) {
        self.rule.complete_tables(&mut self.agent);
    }

    fn tables(&self) -> Vec<&[f64]> {
        let second = self.rule.second_table().map(QTable::values);
        std::iter::once(self.agent.table.values()).chain(second).collect()
    }

    fn policy_tables(&self) -> Vec<&[f64]> {
        if U::HAS_CRITIC { vec![self.agent.table.values()] } else { Learner::<R>::tables(self) }
    }

    fn tables_mut(&mut self) -> Vec<&mut [f64]> {
        let second = self.rule.second_table_mut().map(QTable::values_mut);
        std::iter::once(self.agent.table.values_mut()).chain(second).collect()
    }

    fn shape(&self) -> (usize, usize) {
        self.agent.table.shape()
    }

    fn abandon_episode(&mut self) {
        self.rule.abandon_episode(&mut self.agent);
    }

    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.agent.persist_counts(checkpoint)?;
        self.rule.persist(self.agent.table.shape(), checkpoint)
    }

    #[inline]
    fn diverged(&self) -> bool {
        self.agent.table.diverged() || self.rule.second_table().is_some_and(QTable::diverged)
    }
}
