//! The results of finished episodes.

use super::Budget;
use crate::memory::{AllocationError, reserve};

/// The results of the finished episodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EpisodeLog {
    /// The return of each episode: the undiscounted sum of its rewards.
    pub returns: Vec<f64>,
    /// The number of steps of each episode.
    pub lengths: Vec<i64>,
    /// Whether each episode reached a terminal state, rather than only its time limit.
    pub terminated: Vec<bool>,
}

impl EpisodeLog {
    /// Makes room for all episodes that can finish within a budget, given that each takes at least one step. The loop
    /// then cannot run out of memory.
    pub(super) fn reserve(&mut self, budget: Budget) -> Result<(), AllocationError> {
        let missing = budget.episodes.saturating_sub(self.returns.len()) as u64;
        let count = missing.min(budget.work) as usize;
        reserve(&mut self.returns, count)?;
        reserve(&mut self.lengths, count)?;
        reserve(&mut self.terminated, count)
    }
}
