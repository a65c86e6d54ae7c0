//! The steps of an episode, which Monte Carlo methods learn from when it ends.

use super::agent::MAX_WORK_PER_CALL;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::memory::{AllocationError, RunMemory};

/// A step of an episode, on a table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::learners) struct EpisodeStep<M> {
    /// The row of the state.
    pub(in crate::learners) row: u32,
    /// The action.
    pub(in crate::learners) action: u32,
    /// The reward.
    pub(in crate::learners) reward: f64,
    /// What the method keeps of the choice of the action.
    pub(in crate::learners) memo: M,
}

/// The steps of an unfinished episode, and the learning from them, from the last one backwards, in parts.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::learners) struct EpisodeSteps<M> {
    steps: Vec<EpisodeStep<M>>,
    /// The most steps of an episode.
    limit: u64,
    /// The return G of what follows the steps that are left.
    pub(in crate::learners) following: f64,
    /// Whether the episode is over and steps are left to learn from.
    finishing: bool,
    /// The work of the last call.
    work: u64,
}

impl<M: Copy + Default + Persist> EpisodeSteps<M> {
    /// Before the first episode, whose steps are at most `limit`.
    pub(in crate::learners) fn new(limit: u64) -> Self {
        Self { steps: Vec::new(), limit, following: 0.0, finishing: false, work: 1 }
    }

    /// Makes room for so many steps more.
    pub(in crate::learners) fn reserve(&mut self, work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        let left = self.limit.saturating_sub(self.steps.len() as u64);
        memory.reserve(&mut self.steps, left.min(work) as usize)
    }

    #[inline]
    pub(in crate::learners) fn push(&mut self, row: u32, action: usize, reward: f64, memo: M, work: u64) {
        self.steps.push(EpisodeStep { row, action: action as u32, reward, memo });
        self.work = work;
    }

    /// The steps, oldest first.
    pub(in crate::learners) fn iter(&self) -> impl Iterator<Item = &EpisodeStep<M>> {
        self.steps.iter()
    }

    /// Begins to learn from an episode that is over; `following` is the value of its last state.
    pub(in crate::learners) fn begin(&mut self, following: f64) {
        (self.following, self.finishing) = (following, true);
    }

    /// Calls `learn` for the steps that are left, the last one first, or for a part of them where they are many. It
    /// returns whether to go on.
    pub(in crate::learners) fn finish(
        &mut self,
        work_per_step: u64,
        mut learn: impl FnMut(&mut f64, EpisodeStep<M>) -> bool,
    ) {
        self.work = 1;
        while self.work < MAX_WORK_PER_CALL {
            let Some(step) = self.steps.pop() else {
                self.finishing = false;
                return;
            };
            self.work += work_per_step;
            if !learn(&mut self.following, step) {
                self.abandon();
                return;
            }
        }
        self.finishing = !self.steps.is_empty();
    }

    #[inline]
    pub(in crate::learners) fn is_finishing(&self) -> bool {
        self.finishing
    }

    #[inline]
    pub(in crate::learners) fn work(&self) -> u64 {
        self.work
    }

    /// Forgets the steps.
    pub(in crate::learners) fn abandon(&mut self) {
        self.finishing = false;
        self.steps.clear();
    }

    pub(in crate::learners) fn persist(
        &mut self,
        (num_rows, num_actions): (usize, usize),
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        let (mut count, most) = (self.steps.len(), usize::try_from(self.limit).unwrap_or(usize::MAX));
        checkpoint.index(&mut count, most.saturating_add(1), "number of steps")?;
        if checkpoint.is_restoring() {
            self.steps.clear();
        }
        for index in 0..count {
            if checkpoint.is_restoring() {
                self.steps.try_reserve(1).map_err(|_| CheckpointError::OutOfMemory)?;
                self.steps.push(EpisodeStep::default());
            }
            let EpisodeStep { row, action, reward, memo } = &mut self.steps[index];
            checkpoint.index_u32(row, num_rows, "row")?;
            checkpoint.index_u32(action, num_actions, "action")?;
            (reward, memo).persist(checkpoint)?;
        }
        (&mut self.following, &mut self.finishing).persist(checkpoint)?;
        // An episode that has reached the limit is learned from.
        let is_valid = if self.finishing { !self.steps.is_empty() } else { (self.steps.len() as u64) < self.limit };
        checkpoint.check(is_valid || self.steps.is_empty() && !self.finishing, "number of steps")
    }
}
