//! The steps of an episode, which Monte Carlo methods learn from at its end.

use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::learners::StepInParts;
use crate::memory::{AllocationError, RunMemory};

/// A step of an episode in a table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::learners) struct EpisodeStep<M> {
    /// The row of the state.
    pub(in crate::learners) row: u32,
    /// The action.
    pub(in crate::learners) action: u32,
    /// The reward.
    pub(in crate::learners) reward: f64,
    /// The data that the method stored when the action was chosen.
    pub(in crate::learners) memo: M,
}

/// The steps of an unfinished episode, and the learning from them at its end, from the last one backwards.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::learners) struct EpisodeSteps<M> {
    steps: Vec<EpisodeStep<M>>,
    /// The maximum number of steps of an episode.
    limit: u64,
    /// The return G after the steps that remain to be learned from.
    pub(in crate::learners) following: f64,
    /// The learning at the end of the episode.
    end: StepInParts,
    /// The work of the last step, without the learning at the end of the episode.
    work: u64,
}

impl<M: Copy + Default + Persist> EpisodeSteps<M> {
    /// No steps, before the first episode. Episodes have at most `limit` steps.
    pub(in crate::learners) fn new(limit: u64) -> Self {
        Self { steps: Vec::new(), limit, following: 0.0, end: StepInParts::new(), work: 1 }
    }

    /// Makes room for the steps that this much work can take.
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

    /// Calls `learn` for the steps of a finished episode, the last one first, or for a part of them if there are many.
    /// `learn` updates the return G, takes `work_per_step`, and returns whether to learn from the earlier steps.
    pub(in crate::learners) fn learn_backwards(
        &mut self,
        work_per_step: u64,
        mut learn: impl FnMut(&mut f64, EpisodeStep<M>) -> bool,
    ) {
        let Self { steps, following, end, .. } = self;
        end.advance(|| {
            let Some(step) = steps.pop() else { return (0, false) };
            if !learn(following, step) {
                steps.clear();
            }
            (work_per_step, !steps.is_empty())
        });
    }

    #[inline]
    pub(in crate::learners) fn is_unfinished(&self) -> bool {
        self.end.is_unfinished()
    }

    #[inline]
    pub(in crate::learners) fn work(&self) -> u64 {
        self.work + self.end.work()
    }

    /// Begins the next episode.
    pub(in crate::learners) fn clear(&mut self) {
        self.steps.clear();
        self.end.clear();
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
        (&mut self.following, &mut self.end).persist(checkpoint)?;
        // An episode that has reached the limit is already being learned from.
        let is_valid = if self.is_unfinished() { count > 0 } else { (count as u64) < self.limit || count == 0 };
        checkpoint.check(is_valid, "number of steps")
    }
}
