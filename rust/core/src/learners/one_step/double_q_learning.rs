//! Double Q-learning (H. van Hasselt, 2010; Sutton & Barto, equation 6.10).

use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, learn_borrowed, masked_values};
use crate::numeric::argmax;
use crate::policies::{Policy, assert_takes};
use crate::q_table::QTable;
use crate::random::Rng;
use crate::schedules::{LearningRate, StepSize};
use crate::tasks::Next;

/// Q₁(S, A) ← Q₁(S, A) + α [R + γ Q₂(S′, argmaxₐ Q₁(S′, a)) - Q₁(S, A)] with probability 1/2, otherwise the same with
/// Q₁ and Q₂ exchanged.
///
/// Q₁ is the agent's table. The policy uses Q₁ + Q₂. The argmax takes the first maximum, whatever the policy's tie
/// breaking.
#[derive(Clone, Debug, PartialEq)]
pub struct DoubleQLearning {
    /// The second table, Q₂.
    pub second_table: QTable,
    /// The learning rate of Q₂, which counts only the visits of Q₂.
    pub second_learning_rate: LearningRate,
    /// A buffer for Q₁ + Q₂.
    sums: Vec<f64>,
}

impl DoubleQLearning {
    /// An update rule for an agent with this learning rate, and for a second table.
    pub fn new(learning_rate: LearningRate, second_table: QTable) -> Self {
        let sums = vec![0.0; second_table.num_actions()];
        Self { second_table, second_learning_rate: learning_rate, sums }
    }

    #[inline]
    fn choose<R: ActiveFeatures>(&mut self, agent: &mut Agent, state: &R, rng: &mut impl Rng) -> usize {
        assert_takes(&agent.policy, state);
        let values = agent.action_values(state).iter().zip(self.second_table.action_values(state));
        for (sum, (first, second)) in self.sums.iter_mut().zip(values) {
            *sum = first + second;
        }
        agent.policy.choose_in(state.as_ref(), &self.sums, rng)
    }
}

impl<R: Copy + ActiveFeatures> UpdateRule<R, Agent> for DoubleQLearning {
    #[inline]
    fn first_action(&mut self, agent: &mut Agent, state: R, rng: &mut impl Rng) -> Option<usize> {
        Some(self.choose(agent, &state, rng))
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
        let first = rng.random() < 0.5;
        let Agent { table, learning_rate, discount, terminal_update, masks, .. } = &mut *agent;
        let (updated, other, learning_rate) = if first {
            (table, &self.second_table, learning_rate)
        } else {
            (&mut self.second_table, &*table, &mut self.second_learning_rate)
        };
        match next {
            Next::NonTerminal(next_state) | Next::Truncated(next_state) => {
                let values = updated.action_values(&next_state);
                let greedy = argmax(masked_values::<0>(masks, next_state.as_ref(), values));
                let target = reward + *discount * other.value(&next_state, greedy);
                updated.update(&state, action, target, learning_rate);
            }
            Next::Terminal => {
                updated.update_terminal(&state, action, reward, *terminal_update, learning_rate);
            }
        }
        if let Next::NonTerminal(next_state) = next { self.choose(agent, &next_state, rng) } else { 0 }
    }

    learn_borrowed!(Agent);

    fn second_table(&self) -> Option<&QTable> {
        Some(&self.second_table)
    }

    fn second_table_mut(&mut self) -> Option<&mut QTable> {
        Some(&mut self.second_table)
    }

    fn end_episode(&mut self, _agent: &mut Agent) {
        self.second_learning_rate.end_episode();
    }

    /// The schedules count only finished episodes.
    fn abandon_episode(&mut self, _agent: &mut Agent) {}

    fn persist(&mut self, _shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.second_learning_rate.persist_counts(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};

    fn learner(first: &[f64], second: &[f64]) -> TdLearner<DoubleQLearning> {
        let agent = agent(first);
        let rule = DoubleQLearning::new(agent.learning_rate.clone(), QTable::new(second.to_vec(), 2));
        TdLearner { agent, rule }
    }

    #[test]
    fn each_table_is_updated_with_the_value_of_the_other() {
        let mut learner = learner(&[1.0, 0.0, 2.0, 4.0], &[3.0, 0.0, 8.0, 6.0]);
        let first_values = |learner: &TdLearner<DoubleQLearning>| {
            (learner.agent.table.values()[0], learner.rule.second_table.values()[0])
        };
        // The first random numbers are 0.636… and 0.269…, so Q₂ is updated first and then Q₁.
        let mut rng = rng();
        // The argmax of Q₂ is action 0, whose value in Q₁ is 2: 3 + 0.5 (-1 + 0.5 · 2 - 3)
        learner.learn([0], 0, -1.0, Next::Truncated([1]), &mut rng);
        assert_eq!(first_values(&learner), (1.0, 1.5));
        // The argmax of Q₁ is action 1, whose value in Q₂ is 6: 1 + 0.5 (-1 + 0.5 · 6 - 1)
        learner.learn([0], 0, -1.0, Next::Truncated([1]), &mut rng);
        assert_eq!(first_values(&learner), (1.5, 1.5));
    }

    #[test]
    fn the_policy_uses_the_sum_of_both_tables() {
        assert_eq!(learner(&[1.0, 0.0], &[0.0, 2.0]).first_action([0], &mut rng()), 1);
    }
}
