//! First-visit Monte Carlo: the returns of an episode, each averaged in where its pair first occurred.

use super::EpisodeSteps;
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::learners::{Agent, row_work, single_row};
use crate::memory::{AllocationError, RunMemory, filled};
use crate::random::Rng;
use crate::tasks::Next;

/// The steps of an episode, and how often each state-action pair occurs in those that are left.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::learners) struct FirstVisits {
    steps: EpisodeSteps<()>,
    occurrences: Vec<u32>,
}

impl FirstVisits {
    /// Before the first episode of at most `limit` steps, on a table of so many pairs.
    pub(in crate::learners) fn new(pairs: usize, limit: u64, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        Ok(Self { steps: EpisodeSteps::new(limit), occurrences: filled(&0, pairs, stop)? })
    }

    /// Keeps a step, learns from the episode if it is over, and returns the next action. If it was truncated, the returns
    /// end with the value of an action that is sampled and never taken.
    #[inline]
    pub(in crate::learners) fn learn<R: Copy + AsRef<[u32]>>(
        &mut self,
        agent: &mut Agent,
        (row, action, reward): (u32, usize, f64),
        next: Next<R>,
        rng: &mut impl Rng,
    ) -> usize {
        self.steps.push(row, action, reward, (), agent.work());
        self.occurrences[agent.table.weight_index(row, action)] += 1;
        let following = agent.sample_next(next, rng);
        if !matches!(next, Next::NonTerminal(_)) {
            self.finish(agent, following.map_or(0.0, |(rows, action)| agent.value(rows, action)));
        }
        following.map_or(0, |(_, next_action)| next_action)
    }

    /// G ← γ G + R and, where the pair does not occur earlier, Q(S, A) ← Q(S, A) + α [G - Q(S, A)]. The first G is the value
    /// of the last state.
    fn finish(&mut self, agent: &mut Agent, mut following: f64) {
        for step in self.steps.drain(row_work(agent.table.num_actions())) {
            following = agent.discount * following + step.reward;
            let earlier = &mut self.occurrences[agent.table.weight_index(step.row, step.action as usize)];
            *earlier -= 1;
            if *earlier == 0 {
                agent.update([step.row], step.action as usize, following);
            }
        }
    }

    pub(in crate::learners) fn steps(&self) -> &EpisodeSteps<()> {
        &self.steps
    }

    pub(in crate::learners) fn reserve(&mut self, work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        self.steps.reserve(work, memory)
    }

    /// Forgets the steps of an episode that is given up.
    pub(in crate::learners) fn abandon(&mut self, agent: &Agent) {
        for step in self.steps.iter() {
            self.occurrences[agent.table.weight_index(step.row, step.action as usize)] = 0;
        }
        self.steps.clear();
    }

    pub(in crate::learners) fn persist(
        &mut self,
        shape: (usize, usize),
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        self.steps.persist(shape, checkpoint)?;
        if checkpoint.is_restoring() {
            self.occurrences.fill(0);
            for step in self.steps.iter() {
                self.occurrences[step.row as usize * shape.1 + step.action as usize] += 1;
            }
        }
        Ok(())
    }
}

/// The row of a step's state, its action and its reward.
#[inline]
pub(in crate::learners) fn step_of<R: AsRef<[u32]>>(state: &R, action: usize, reward: f64) -> (u32, usize, f64) {
    (single_row(state), action, reward)
}
