//! n-step Sarsa (Sutton & Barto, equations 7.4 and 7.5, and the box in section 7.2).

use std::collections::VecDeque;

use super::Agent;
use crate::learner::Learner;
use crate::random::Draw;
use crate::world::Next;

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
    /// Q, the policy and the constants.
    pub agent: Agent,
    steps: usize,
    /// The last visits, oldest first: never more than n.
    visits: VecDeque<Visit<R>>,
}

impl<R: Copy + AsRef<[u32]>> NStepSarsa<R> {
    /// Targets of `steps` rewards.
    ///
    /// # Panics
    /// If `steps` is zero.
    pub fn new(agent: Agent, steps: usize) -> Self {
        assert!(steps > 0, "a target has at least one reward");
        Self { agent, steps, visits: VecDeque::with_capacity(steps) }
    }

    /// The update of the oldest visit; `end` is what follows the newest, unless nothing does.
    fn update_oldest(&mut self, end: Option<(R, usize)>) {
        let (mut target, mut power) = (0.0, 1.0);
        for visit in &self.visits {
            target += power * visit.reward;
            power *= self.agent.discount;
        }
        if let Some((rows, action)) = end {
            target += power * self.agent.value(rows, action);
        }
        if let Some(Visit { rows, action, .. }) = self.visits.pop_front() {
            self.agent.move_towards(rows, action, target);
        }
    }

    fn update_all(&mut self, end: Option<(R, usize)>) {
        while !self.visits.is_empty() {
            self.update_oldest(end);
        }
    }
}

impl<R: Copy + AsRef<[u32]>> Learner<R> for NStepSarsa<R> {
    #[inline]
    fn begin(&mut self, here: R, draw: &mut impl Draw) -> usize {
        self.agent.choose(here, draw)
    }

    #[inline]
    fn learn(&mut self, here: R, action: usize, reward: f64, next: Next<R>, draw: &mut impl Draw) -> usize {
        self.visits.push_back(Visit { rows: here, action, reward });
        match next {
            Next::Goes(there) => {
                let next_action = self.agent.choose(there, draw);
                if self.visits.len() == self.steps {
                    self.update_oldest(Some((there, next_action)));
                }
                next_action
            }
            Next::TimedOut(there) => {
                let next_action = self.agent.choose(there, draw);
                self.update_all(Some((there, next_action)));
                next_action
            }
            Next::Terminal => {
                self.update_all(None);
                0
            }
        }
    }

    fn end_episode(&mut self) {
        self.agent.end_episode();
    }

    fn tables(&self) -> Vec<&[f64]> {
        vec![self.agent.table.values()]
    }

    fn diverged(&self) -> bool {
        self.agent.table.diverged()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::example::{agent, draw};

    #[test]
    fn two_rewards_and_what_follows_by_hand() {
        let mut learner = NStepSarsa::new(agent(&[1.0, 0.0, 2.0, 3.0, 4.0, 8.0]), 2);
        assert_eq!(learner.learn([0], 0, -1.0, Next::Goes([1]), &mut draw()), 1);
        assert_eq!(learner.agent.table.values()[0], 1.0);
        learner.learn([1], 1, -2.0, Next::Goes([2]), &mut draw());
        // 1 + 0.5 (-1 + 0.5 · -2 + 0.25 · 8 - 1)
        assert_eq!(learner.agent.table.values()[0], 0.5);
    }

    #[test]
    fn the_last_visits_are_updated_when_the_episode_ends() {
        let mut learner = NStepSarsa::new(agent(&[1.0, 0.0, 2.0, 3.0]), 5);
        learner.learn([0], 0, -1.0, Next::Goes([1]), &mut draw());
        learner.learn([1], 1, -2.0, Next::Terminal, &mut draw());
        // 1 + 0.5 (-1 + 0.5 · -2 - 1), then 3 + 0.5 (-2 - 3)
        assert_eq!(learner.agent.table.values(), [-0.5, 0.0, 2.0, 0.5]);
    }
}
