//! A model of a stochastic environment: the number of times that each outcome followed each state-action pair.

use super::outcome_trees::{OutcomeTrees, Root};
use super::{DynaModel, Model, ModelEntry};
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::memory::{AllocationError, MemoryRoom, RunMemory, filled};
use crate::random::Rng;

/// The outcomes of each pair in the order in which they were first seen, with their counts.
#[derive(Clone, Debug, PartialEq)]
pub struct StochasticModel {
    /// The pairs that were tried, in the order of their first trials.
    tried: Model,
    /// The outcomes of each pair.
    roots: Vec<Root>,
    trees: OutcomeTrees,
}

impl StochasticModel {
    /// An empty model, with room for all pairs.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(rows: usize, num_actions: usize, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        let (tried, roots) = (Model::new(rows, num_actions, stop)?, filled(&Root::EMPTY, rows * num_actions, stop)?);
        Ok(Self { tried, roots, trees: OutcomeTrees::new() })
    }

    /// The index of a pair.
    #[inline]
    fn pair(&self, row: u32, action: usize) -> usize {
        row as usize * self.tried.num_actions() + action
    }
}

impl DynaModel for StochasticModel {
    #[inline]
    fn tried(&self) -> &Model {
        &self.tried
    }

    fn record(&mut self, row: u32, action: usize, entry: ModelEntry) {
        self.tried.record(row, action, entry);
        let pair = self.pair(row, action);
        self.trees.count(&mut self.roots[pair], pair, entry, 1);
    }

    /// Draws one `integers` below the number of times that the pair was tried.
    fn sample(&self, row: u32, action: usize, rng: &mut impl Rng) -> Option<ModelEntry> {
        let root = self.roots[self.pair(row, action)];
        let left = rng.integers(self.trees.total(root).max(1));
        self.trees.at(root, left)
    }

    /// The depth of a tree is the logarithm of its number of outcomes.
    #[inline]
    fn work(&self) -> u64 {
        u64::from(self.trees.len().checked_ilog2().unwrap_or(0))
    }

    fn reserve(&mut self, transitions: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        self.trees.reserve(usize::try_from(transitions).unwrap_or(usize::MAX), memory)
    }
}

/// The outcomes of each pair that was tried, in the order of the pairs.
impl Persist for StochasticModel {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.tried.persist(checkpoint)?;
        if checkpoint.is_restoring() {
            self.roots.fill(Root::EMPTY);
            self.trees = OutcomeTrees::new();
        }
        let num_actions = self.tried.num_actions();
        for pair in 0..self.roots.len() {
            if self.tried.entry((pair / num_actions) as u32, pair % num_actions).is_some() {
                self.persist_outcomes(pair, checkpoint)?;
            }
        }
        Ok(())
    }
}

impl StochasticModel {
    fn persist_outcomes(&mut self, pair: usize, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        const WHAT: &str = "outcome of the model";
        let num_rows = self.roots.len() / self.tried.num_actions();
        let mut outcomes = self.roots[pair].len() as usize;
        checkpoint.index(&mut outcomes, usize::MAX, "number of outcomes")?;
        checkpoint.check(outcomes > 0, WHAT)?;
        for index in 0..outcomes {
            let (mut entry, mut count) = if checkpoint.is_restoring() {
                (ModelEntry { reward: 0.0, next: None }, 0)
            } else {
                self.trees.outcome(self.roots[pair], index as u32)
            };
            (&mut entry.reward, &mut entry.next, &mut count).persist(checkpoint)?;
            checkpoint.check(entry.next.is_none_or(|next| (next as usize) < num_rows), WHAT)?;
            checkpoint.check(count > 0, WHAT)?;
            if checkpoint.is_restoring() {
                let mut memory = RunMemory::new(MemoryRoom::unlimited());
                self.trees.reserve(1, &mut memory).map_err(|_| CheckpointError::OutOfMemory)?;
                let counted = self.trees.count(&mut self.roots[pair], pair, entry, count);
                checkpoint.check(counted, WHAT)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::rng;

    #[test]
    fn outcomes_are_sampled_as_often_as_they_were_seen() {
        let mut model = StochasticModel::new(2, 2, &StopFlag::new()).expect("a few pairs");
        model.reserve(4, &mut RunMemory::new(MemoryRoom::unlimited())).expect("a few outcomes");
        let often = ModelEntry { reward: 1.0, next: Some(1) };
        let rare = ModelEntry { reward: 1.0, next: None };
        for entry in [often, rare, often, often] {
            model.record(0, 1, entry);
        }
        let mut rng = rng();
        let sampled = (0..4000).filter(|_| model.sample(0, 1, &mut rng) == Some(often)).count();
        assert!((2900..3100).contains(&sampled), "{sampled}");
        assert_eq!(model.sample(0, 0, &mut rng), None);
    }
}
