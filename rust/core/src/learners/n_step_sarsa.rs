//! n-step Sarsa (Sutton & Barto, equations 7.4 and 7.5, and the box in section 7.2).

use std::collections::VecDeque;

use super::common::{Agent, MAX_WORK_PER_CALL, UpdateRule, VALUES_PER_WORK};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist, persist_rows};
use crate::features::ActiveRows;
use crate::memory::{AllocationError, out_of_memory};
use crate::random::Rng;
use crate::tasks::Next;

/// A state-action pair that awaits its update, and the reward that followed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Visit<R> {
    rows: R,
    action: usize,
    reward: f64,
}

/// Q(Sₜ, Aₜ) ← Q(Sₜ, Aₜ) + α [G - Q(Sₜ, Aₜ)] with the n-step return
/// G = Rₜ₊₁ + γ Rₜ₊₂ + … + γⁿ⁻¹ Rₜ₊ₙ + γⁿ Q(Sₜ₊ₙ, Aₜ₊ₙ).
///
/// The sum runs from left to right, and the powers of γ are a running product. At the end of an episode the last n pairs
/// are updated with shorter returns.
#[derive(Clone, Debug, PartialEq)]
pub struct NStepSarsa<R> {
    n: usize,
    /// The last visits, oldest first, at most n.
    visits: VecDeque<Visit<R>>,
    /// What the returns of the last pairs of a finished episode end with: the pair after the newest reward, or `None`
    /// after a terminal state.
    bootstrap: Option<(R, usize)>,
    /// Whether the episode is finished and pairs still await their updates.
    finishing: bool,
    /// The work of the updates at the end of the episode, in the last call.
    finishing_work: u64,
}

impl<R: ActiveRows> NStepSarsa<R> {
    /// Targets of `n` rewards.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn new(n: usize) -> Self {
        assert!(n > 0, "n_steps must be at least 1, got 0");
        Self { n, visits: VecDeque::new(), bootstrap: None, finishing: false, finishing_work: 0 }
    }

    /// The work of an update.
    #[inline]
    fn update_work(&self, agent: &Agent) -> u64 {
        agent.work() + self.visits.len() as u64 / VALUES_PER_WORK
    }

    /// Updates the oldest pair. `bootstrap` is the pair after the newest reward, or `None` after a terminal state.
    #[inline]
    fn update_oldest(&mut self, agent: &mut Agent, bootstrap: Option<(R, usize)>) {
        let (mut target, mut power) = (0.0, 1.0);
        for visit in &self.visits {
            target += power * visit.reward;
            power *= agent.discount;
        }
        if let Some((rows, action)) = bootstrap {
            target += power * agent.value(rows, action);
        }
        if let Some(Visit { rows, action, .. }) = self.visits.pop_front() {
            agent.update(rows, action, target);
        }
    }

    /// Updates the last pairs of an episode, or a part of them where they are many.
    #[inline(never)]
    fn finish(&mut self, agent: &mut Agent) {
        self.finishing_work = 0;
        while !self.visits.is_empty() && self.finishing_work < MAX_WORK_PER_CALL {
            self.finishing_work += self.update_work(agent);
            self.update_oldest(agent, self.bootstrap);
        }
        self.finishing = !self.visits.is_empty();
    }
}

impl<R: ActiveRows> UpdateRule<R, Agent> for NStepSarsa<R> {
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
        self.visits.push_back(Visit { rows: state, action, reward });
        let bootstrap = agent.sample_next(next, rng);
        if !matches!(next, Next::NonTerminal(_)) {
            self.bootstrap = bootstrap;
            self.finish(agent);
        } else if self.visits.len() == self.n {
            self.update_oldest(agent, bootstrap);
        }
        bootstrap.map_or(0, |(_, next_action)| next_action)
    }

    #[inline]
    fn work(&self, agent: &Agent) -> u64 {
        self.update_work(agent) + self.finishing_work
    }

    fn end_episode(&mut self, _agent: &mut Agent) {
        self.finishing_work = 0;
    }

    /// An episode has as many pairs as steps, and at most n of them wait.
    fn reserve(&mut self, _agent: &mut Agent, work: u64) -> Result<(), AllocationError> {
        let count = ((self.n - self.visits.len()) as u64).min(work) as usize;
        self.visits.try_reserve(count).map_err(out_of_memory::<Visit<R>>(count))
    }

    #[inline]
    fn is_unfinished(&self) -> bool {
        self.finishing
    }

    fn resume(&mut self, agent: &mut Agent, _next: Next<R>, _rng: &mut impl Rng) -> usize {
        self.finish(agent);
        self.bootstrap.map_or(0, |(_, next_action)| next_action)
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
            let (mut action, mut reward) = saved.map_or((0, 0.0), |visit| (visit.action, visit.reward));
            checkpoint.index(&mut action, num_actions, "action")?;
            reward.persist(checkpoint)?;
            if checkpoint.is_restoring() {
                self.visits.push_back(Visit { rows, action, reward });
            }
        }
        let mut bootstraps = self.bootstrap.is_some();
        (&mut self.finishing, &mut bootstraps).persist(checkpoint)?;
        self.bootstrap = if bootstraps {
            let rows = persist_rows(self.bootstrap.map(|(rows, _)| rows), num_rows, checkpoint)?;
            let mut action = self.bootstrap.map_or(0, |(_, action)| action);
            checkpoint.index(&mut action, num_actions, "action")?;
            Some((rows, action))
        } else {
            None
        };
        Ok(())
    }

    /// The pairs that await their updates are forgotten.
    fn abandon_episode(&mut self, _agent: &mut Agent) {
        self.finishing = false;
        self.visits.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::common::test_support::{agent, rng};
    use crate::learners::common::{Learner, TdLearner};

    #[test]
    fn one_update_by_hand() {
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0, 4.0, 8.0]), rule: NStepSarsa::new(2) };
        assert_eq!(learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng()), 1);
        assert_eq!(learner.agent.table.values()[0], 1.0);
        learner.learn([1], 1, -2.0, Next::NonTerminal([2]), &mut rng());
        // 1 + 0.5 (-1 + 0.5 · -2 + 0.25 · 8 - 1)
        assert_eq!(learner.agent.table.values()[0], 0.5);
    }

    #[test]
    fn the_last_pairs_are_updated_when_the_episode_ends() {
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: NStepSarsa::new(5) };
        learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng());
        learner.learn([1], 1, -2.0, Next::Terminal, &mut rng());
        // 1 + 0.5 (-1 + 0.5 · -2 - 1), then 3 + 0.5 (-2 - 3)
        assert_eq!(learner.agent.table.values(), [-0.5, 0.0, 2.0, 0.5]);
    }
}
