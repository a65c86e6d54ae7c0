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
    /// The number of episodes.
    pub fn len(&self) -> usize {
        self.returns.len()
    }

    /// Whether there are no episodes.
    pub fn is_empty(&self) -> bool {
        self.returns.is_empty()
    }

    /// The mean return of the last `episodes` episodes, or of all if there are fewer; NaN if there are none.
    pub fn mean_return(&self, episodes: usize) -> f64 {
        let last = &self.returns[self.len().saturating_sub(episodes)..];
        last.iter().sum::<f64>() / last.len() as f64
    }

    /// Adds an episode.
    pub(super) fn push(&mut self, episode_return: f64, length: i64, terminated: bool) {
        self.returns.push(episode_return);
        self.lengths.push(length);
        self.terminated.push(terminated);
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_is_that_of_the_last_episodes() {
        let log = EpisodeLog { returns: vec![9.0, 1.0, 2.0], lengths: vec![1; 3], terminated: vec![true; 3] };
        assert_eq!((log.len(), log.mean_return(2), log.mean_return(100)), (3, 1.5, 4.0));
        assert!(EpisodeLog::default().is_empty() && EpisodeLog::default().mean_return(9).is_nan());
    }
}
