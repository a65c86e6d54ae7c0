//! The steps of an episode, which Monte Carlo methods learn from when it ends.

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

/// The steps of an unfinished episode, which are learned from at its end, from the last one backwards.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::learners) struct EpisodeSteps<M> {
    steps: Vec<EpisodeStep<M>>,
    /// The most steps of an episode.
    limit: u64,
    /// The work of the last step.
    work: u64,
}

impl<M: Copy + Default + Persist> EpisodeSteps<M> {
    /// Before the first episode, whose steps are at most `limit`.
    pub(in crate::learners) fn new(limit: u64) -> Self {
        Self { steps: Vec::new(), limit, work: 1 }
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

    /// Takes out the steps of an episode that is over, the last one first, for an update that does so much work for each.
    pub(in crate::learners) fn drain(&mut self, work_per_step: u64) -> impl Iterator<Item = EpisodeStep<M>> {
        self.work = 1 + work_per_step * self.steps.len() as u64;
        self.steps.drain(..).rev()
    }

    #[inline]
    pub(in crate::learners) fn work(&self) -> u64 {
        self.work
    }

    /// Forgets the steps.
    pub(in crate::learners) fn clear(&mut self) {
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
        // An episode that has reached the limit was learned from.
        checkpoint.check((self.steps.len() as u64) < self.limit || self.steps.is_empty(), "number of steps")
    }
}
