//! Differential Q-learning for continuing tasks (Sutton & Barto, section 10.3 and Exercise 10.4; A. Schwartz, 1993, as
//! R-learning).

use super::AverageReward;
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::features::ActiveRows;
use crate::learners::{Agent, UpdateRule};
use crate::numeric::maximum;
use crate::random::Rng;
use crate::tasks::Next;

/// δ = R - R̄ + maxₐ Q(S′, a) - Q(S, A), R̄ ← R̄ + β δ, Q(S, A) ← Q(S, A) + α δ.
///
/// R̄ estimates the average reward of the greedy policy; there is no discount.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DifferentialQLearning<R> {
    average_reward: AverageReward<R>,
}

impl<R: ActiveRows> DifferentialQLearning<R> {
    /// An update rule before the first step, with the step size β of the average reward.
    pub fn new(step_size: f64) -> Self {
        Self { average_reward: AverageReward::new(step_size) }
    }
}

impl<R: ActiveRows> UpdateRule<R, Agent> for DifferentialQLearning<R> {
    fn first_action(&mut self, agent: &mut Agent, state: R, rng: &mut impl Rng) -> Option<usize> {
        let action = agent.choose(state, rng);
        if let Some(step) = self.average_reward.take_waiting() {
            let following = maximum(agent.action_values(state));
            self.average_reward.learn(agent, step, following);
        }
        Some(action)
    }

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
        let step = (state, action, reward);
        match next {
            Next::NonTerminal(next_state) | Next::Truncated(next_state) => {
                let following = maximum(agent.action_values(next_state));
                self.average_reward.learn(agent, step, following);
            }
            Next::Terminal => self.average_reward.wait(step),
        }
        agent.next_action(next, rng)
    }

    fn average_reward(&self) -> Option<f64> {
        Some(self.average_reward.value())
    }

    fn persist(&mut self, shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.average_reward.persist(shape, checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};

    #[test]
    fn one_update_by_hand() {
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: DifferentialQLearning::new(0.25) };
        assert_eq!(learner.learn([0], 0, 6.0, Next::NonTerminal([1]), &mut rng()), 1);
        // δ = 6 + 3 - 1 = 8
        assert_eq!((learner.agent.table.values()[0], learner.average_reward()), (5.0, Some(2.0)));
        learner.learn([0], 0, 6.0, Next::Terminal, &mut rng());
        assert_eq!(learner.agent.table.values()[0], 5.0);
        learner.first_action([1], &mut rng());
        // δ = 6 - 2 + 3 - 5 = 2
        assert_eq!((learner.agent.table.values()[0], learner.average_reward()), (6.0, Some(2.5)));
    }
}
