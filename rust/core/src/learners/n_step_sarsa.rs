//! n-step Sarsa (Sutton & Barto, equations 7.4 and 7.5, and the box in section 7.2).

use std::collections::VecDeque;

use super::common::{Agent, UpdateRule};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::{ActiveRows, MAX_TILINGS};
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
}

impl<R: ActiveRows> NStepSarsa<R> {
    /// Targets of `n` rewards.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn new(n: usize) -> Self {
        assert!(n > 0, "n_steps must be at least 1, got 0");
        Self { n, visits: VecDeque::with_capacity(n) }
    }

    /// Updates the oldest pair. `bootstrap` is the pair after the newest reward, or `None` after a terminal state.
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

    fn update_all(&mut self, agent: &mut Agent, bootstrap: Option<(R, usize)>) {
        while !self.visits.is_empty() {
            self.update_oldest(agent, bootstrap);
        }
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
            self.update_all(agent, bootstrap);
        } else if self.visits.len() == self.n {
            self.update_oldest(agent, bootstrap);
        }
        bootstrap.map_or(0, |(_, next_action)| next_action)
    }

    fn persist(
        &mut self,
        (num_rows, num_actions): (usize, usize),
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        let mut count = self.visits.len();
        checkpoint.index(&mut count, self.n, "number of steps")?;
        let mut visits = VecDeque::with_capacity(self.n);
        for index in 0..count {
            let saved = self.visits.get(index).filter(|_| !checkpoint.is_restoring());
            let mut rows = saved.map_or_else(Vec::new, |visit| visit.rows.as_ref().to_vec());
            let (mut active, mut action) = (rows.len(), saved.map_or(0, |visit| visit.action));
            let mut reward = saved.map_or(0.0, |visit| visit.reward);
            checkpoint.index(&mut active, MAX_TILINGS + 1, "number of active rows")?;
            rows.resize(active, 0);
            for row in &mut rows {
                checkpoint.index_u32(row, num_rows, "row")?;
            }
            checkpoint.index(&mut action, num_actions, "action")?;
            reward.persist(checkpoint)?;
            let rows = R::try_from(&rows).map_err(|_| CheckpointError::Invalid("number of active rows"))?;
            visits.push_back(Visit { rows, action, reward });
        }
        self.visits = visits;
        Ok(())
    }

    /// The pairs that await their updates are forgotten.
    fn abandon_episode(&mut self) {
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
