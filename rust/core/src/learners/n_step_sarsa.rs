//! n-step Sarsa (Sutton & Barto, equations 7.4 and 7.5, and the box in section 7.2).

use std::collections::VecDeque;

use super::common::{Agent, UpdateRule};
use crate::random::Rng;
use crate::tasks::Next;

/// A pair on its way to its update, and the reward that followed it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Visit<R> {
    rows: R,
    action: usize,
    reward: f64,
}

/// Q(Sₜ, Aₜ) ← Q(Sₜ, Aₜ) + α [Rₜ₊₁ + γ Rₜ₊₂ + … + γⁿ⁻¹ Rₜ₊ₙ + γⁿ Q(Sₜ₊ₙ, Aₜ₊ₙ) - Q(Sₜ, Aₜ)], added from the left, the
/// powers of γ as a running product.
#[derive(Clone, Debug, PartialEq)]
pub struct NStepSarsa<R> {
    steps: usize,
    /// The last visits, oldest first: never more than n.
    visits: VecDeque<Visit<R>>,
}

impl<R: Copy + AsRef<[u32]>> NStepSarsa<R> {
    /// Targets of `steps` rewards.
    ///
    /// # Panics
    /// If `steps` is zero.
    pub fn new(steps: usize) -> Self {
        assert!(steps > 0, "a target has at least one reward");
        Self { steps, visits: VecDeque::with_capacity(steps) }
    }

    /// The update of the oldest visit; `end` is what follows the newest, unless nothing does.
    fn update_oldest(&mut self, agent: &mut Agent, end: Option<(R, usize)>) {
        let (mut target, mut power) = (0.0, 1.0);
        for visit in &self.visits {
            target += power * visit.reward;
            power *= agent.discount;
        }
        if let Some((rows, action)) = end {
            target += power * agent.value(rows, action);
        }
        if let Some(Visit { rows, action, .. }) = self.visits.pop_front() {
            agent.update(rows, action, target);
        }
    }

    fn update_all(&mut self, agent: &mut Agent, end: Option<(R, usize)>) {
        while !self.visits.is_empty() {
            self.update_oldest(agent, end);
        }
    }
}

impl<R: Copy + AsRef<[u32]>> UpdateRule<R, Agent> for NStepSarsa<R> {
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
        let end = agent.sample_next(next, rng);
        if !matches!(next, Next::NonTerminal(_)) {
            self.update_all(agent, end);
        } else if self.visits.len() == self.steps {
            self.update_oldest(agent, end);
        }
        end.map_or(0, |(_, next_action)| next_action)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::common::test_support::{agent, rng};
    use crate::learners::common::{Learner, TdLearner};

    #[test]
    fn two_rewards_and_what_follows_by_hand() {
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0, 4.0, 8.0]), rule: NStepSarsa::new(2) };
        assert_eq!(learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng()), 1);
        assert_eq!(learner.agent.table.values()[0], 1.0);
        learner.learn([1], 1, -2.0, Next::NonTerminal([2]), &mut rng());
        // 1 + 0.5 (-1 + 0.5 · -2 + 0.25 · 8 - 1)
        assert_eq!(learner.agent.table.values()[0], 0.5);
    }

    #[test]
    fn the_last_visits_are_updated_when_the_episode_ends() {
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: NStepSarsa::new(5) };
        learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng());
        learner.learn([1], 1, -2.0, Next::Terminal, &mut rng());
        // 1 + 0.5 (-1 + 0.5 · -2 - 1), then 3 + 0.5 (-2 - 3)
        assert_eq!(learner.agent.table.values(), [-0.5, 0.0, 2.0, 0.5]);
    }
}
