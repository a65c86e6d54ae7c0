//! The common part of n-step methods: the pairs that await their updates (Sutton & Barto, chapter 7).

use std::collections::VecDeque;

use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::{ActiveFeatures, ActiveRows, persist_rows};
use crate::learners::VALUES_PER_WORK;
use crate::learners::{Agent, StepInParts, UpdateRule};
use crate::memory::{AllocationError, RunMemory};
use crate::random::Rng;
use crate::tasks::Next;

/// A state-action pair that awaits its update, with the reward that followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NStepVisit<R, M> {
    /// The active rows of the state.
    pub rows: R,
    /// The action.
    pub action: usize,
    /// The reward.
    pub reward: f64,
    /// The data that the method stored when the action was chosen.
    pub memo: M,
}

/// The parts in which n-step methods differ.
pub trait NStepMethod<R> {
    /// The data stored when an action is chosen.
    type Memo: Copy + Default + Persist;

    /// The data to store when an action is chosen, before any value changes.
    fn memo<F: Copy + ActiveFeatures>(&self, agent: &mut Agent, rows: F, action: usize) -> Self::Memo;

    /// Updates the oldest pair, the first of the visits. `following` is the pair after the newest reward, or `None`
    /// after a terminal state; its active rows can be borrowed.
    fn update<F: Copy + ActiveFeatures>(
        &self,
        agent: &mut Agent,
        visits: &VecDeque<NStepVisit<R, Self::Memo>>,
        following: Option<(F, usize)>,
    );

    /// The work of an update with this many visits, given that of reading a row.
    #[inline]
    fn work(row_work: u64, visits: usize) -> u64 {
        row_work + visits as u64 / VALUES_PER_WORK
    }
}

/// An n-step method: the update of a pair waits for n rewards, or for the end of the episode.
#[derive(Clone, Debug, PartialEq)]
pub struct NStep<R, M: NStepMethod<R>> {
    method: M,
    n: usize,
    /// The last visits, oldest first, at most n.
    visits: VecDeque<NStepVisit<R, M::Memo>>,
    /// The data stored when the next action was chosen.
    memo: M::Memo,
    /// The pair after the newest reward of a finished episode, or `None` after a terminal state.
    following: Option<(R, usize)>,
    /// The updates at the end of the episode.
    end: StepInParts,
}

impl<R: ActiveRows, M: NStepMethod<R>> NStep<R, M> {
    /// Targets of `n` rewards.
    ///
    /// # Panics
    /// If `n` is 0.
    pub(in crate::learners) fn with_method(method: M, n: usize) -> Self {
        assert!(n > 0, "n_steps must be at least 1, got 0");
        let (visits, memo) = (VecDeque::new(), M::Memo::default());
        Self { method, n, visits, memo, following: None, end: StepInParts::new() }
    }

    /// Learns from a step with the active rows of its next state, or references to them, of which `owned` returns a copy.
    #[inline(always)]
    fn step<F: Copy + ActiveFeatures>(
        &mut self,
        agent: &mut Agent,
        (rows, action, reward): (R, usize, f64),
        next: Next<F>,
        owned: impl Fn(F) -> R,
        rng: &mut impl Rng,
    ) -> usize {
        self.visits.push_back(NStepVisit { rows, action, reward, memo: self.memo });
        let following = agent.sample_next(next, rng);
        if let Some((rows, next_action)) = following {
            self.memo = self.method.memo(agent, rows, next_action);
        }
        if !matches!(next, Next::NonTerminal(_)) {
            self.following = following.map(|(rows, action)| (owned(rows), action));
            self.update_remaining(agent);
        } else if self.visits.len() == self.n {
            self.method.update(agent, &self.visits, following);
            self.visits.pop_front();
        }
        following.map_or(0, |(_, next_action)| next_action)
    }

    /// Updates the last pairs of an episode, or a part of them if there are many.
    #[inline(never)]
    fn update_remaining(&mut self, agent: &mut Agent) {
        let Self { method, visits, following, end, .. } = self;
        end.advance(|| {
            let work = M::work(agent.work_of::<R>(), visits.len());
            method.update(agent, visits, *following);
            visits.pop_front();
            (work, !visits.is_empty())
        });
    }
}

impl<R: ActiveRows, M: NStepMethod<R>> UpdateRule<R, Agent> for NStep<R, M> {
    #[inline]
    fn first_action(&mut self, agent: &mut Agent, state: R, rng: &mut impl Rng) -> Option<usize> {
        let action = agent.choose(state, rng);
        self.memo = self.method.memo(agent, state, action);
        Some(action)
    }

    #[inline]
    fn learn(
        &mut self,
        agent: &mut Agent,
        state: R,
        action: usize,
        reward: f64,
        next: Next<R>,
        rng: &mut impl Rng,
    ) -> usize {
        self.step(agent, (state, action, reward), next, |rows| rows, rng)
    }

    #[inline]
    fn learn_borrowed(
        &mut self,
        agent: &mut Agent,
        state: &R,
        action: usize,
        reward: f64,
        next: Next<&R>,
        rng: &mut impl Rng,
    ) -> usize {
        self.step(agent, (*state, action, reward), next, |rows| *rows, rng)
    }

    #[inline]
    fn work(&self, row_work: u64) -> u64 {
        M::work(row_work, self.visits.len()) + self.end.work()
    }

    fn end_episode(&mut self, _agent: &mut Agent) {
        self.visits.clear();
        self.end.clear();
    }

    /// An episode has as many pairs as steps, and at most n of them await their updates.
    fn reserve(&mut self, _agent: &mut Agent, work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        let count = ((self.n - self.visits.len()) as u64).min(work) as usize;
        memory.reserve(&mut self.visits, count)
    }

    #[inline]
    fn is_unfinished(&self) -> bool {
        self.end.is_unfinished()
    }

    fn resume(&mut self, agent: &mut Agent, _next: Next<R>, _rng: &mut impl Rng) -> usize {
        self.update_remaining(agent);
        self.following.map_or(0, |(_, next_action)| next_action)
    }

    fn persist(
        &mut self,
        (num_rows, num_actions): (usize, usize),
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        let mut count = self.visits.len();
        checkpoint.index(&mut count, self.n + 1, "number of steps")?;
        if checkpoint.is_restoring() {
            self.visits.clear();
            self.visits.try_reserve(count).map_err(|_| CheckpointError::OutOfMemory)?;
        }
        for index in 0..count {
            let saved = self.visits.get(index).copied();
            let rows = persist_rows(saved.map(|visit| visit.rows), num_rows, checkpoint)?;
            let (mut action, mut reward, mut memo) =
                saved.map_or((0, 0.0, M::Memo::default()), |visit| (visit.action, visit.reward, visit.memo));
            checkpoint.index(&mut action, num_actions, "action")?;
            (&mut reward, &mut memo).persist(checkpoint)?;
            if checkpoint.is_restoring() {
                self.visits.push_back(NStepVisit { rows, action, reward, memo });
            }
        }
        self.memo.persist(checkpoint)?;
        let mut follows = self.following.is_some();
        (&mut self.end, &mut follows).persist(checkpoint)?;
        let is_valid = if self.end.is_unfinished() { count > 0 } else { count < self.n };
        checkpoint.check(is_valid, "number of steps")?;
        self.following = if follows {
            let rows = persist_rows(self.following.map(|(rows, _)| rows), num_rows, checkpoint)?;
            let mut action = self.following.map_or(0, |(_, action)| action);
            checkpoint.index(&mut action, num_actions, "action")?;
            Some((rows, action))
        } else {
            None
        };
        Ok(())
    }
}
