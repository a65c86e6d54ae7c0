//! Double Q-learning (van Hasselt, 2010; Sutton & Barto, equation 6.10).

use super::common::{Agent, Learner};
use crate::numeric::argmax;
use crate::policies::Policy;
use crate::q_table::QTable;
use crate::random::Rng;
use crate::schedules::{LearningRate, StepSize};
use crate::tasks::Next;

/// Q₁(S, A) ← Q₁(S, A) + α [R + γ Q₂(S′, argmaxₐ Q₁(S′, a)) - Q₁(S, A)], or the same with Q₁ and Q₂ exchanged: a coin
/// decides. Actions are chosen by Q₁ + Q₂. The argmax is the first, whatever the policy does with ties.
#[derive(Clone, Debug, PartialEq)]
pub struct DoubleQLearning {
    /// Q₁, the policy and the constants.
    pub agent: Agent,
    /// Q₂.
    pub second: QTable,
    /// Q₂'s own α: it counts its own visits.
    pub second_rate: LearningRate,
    both: Vec<f64>,
}

impl DoubleQLearning {
    /// An agent with a second table.
    pub fn new(agent: Agent, second: QTable) -> Self {
        let both = vec![0.0; second.num_actions()];
        let second_rate = agent.learning_rate.clone();
        Self { agent, second, second_rate, both }
    }

    #[inline]
    fn choose(&mut self, rows: &[u32], rng: &mut impl Rng) -> usize {
        self.both.copy_from_slice(self.agent.table.action_values(rows));
        for (sum, value) in self.both.iter_mut().zip(self.second.action_values(rows)) {
            *sum += value;
        }
        self.agent.policy.choose(&self.both, rng)
    }
}

impl<R: Copy + AsRef<[u32]>> Learner<R> for DoubleQLearning {
    #[inline]
    fn first_action(&mut self, state: R, rng: &mut impl Rng) -> usize {
        self.choose(state.as_ref(), rng)
    }

    #[inline]
    fn learn(&mut self, state: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize {
        let first = rng.random() < 0.5;
        let Agent { table, learning_rate, discount, terminal_update, .. } = &mut self.agent;
        let (own, other, rate) = if first {
            (table, &self.second, learning_rate)
        } else {
            (&mut self.second, &*table, &mut self.second_rate)
        };
        match next {
            Next::NonTerminal(next_state) | Next::Truncated(next_state) => {
                let greedy = argmax(own.action_values(next_state.as_ref()));
                let target = reward + *discount * other.value(next_state.as_ref(), greedy);
                own.update(state.as_ref(), action, target, rate);
            }
            Next::Terminal => own.update_terminal(state.as_ref(), action, reward, *terminal_update, rate),
        }
        if let Next::NonTerminal(next_state) = next { self.choose(next_state.as_ref(), rng) } else { 0 }
    }

    fn end_episode(&mut self) {
        self.agent.end_episode();
        self.second_rate.end_episode();
    }

    fn tables(&self) -> Vec<&[f64]> {
        vec![self.agent.table.values(), self.second.values()]
    }

    fn diverged(&self) -> bool {
        self.agent.table.diverged() || self.second.diverged()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::common::test_support::{agent, rng};

    #[test]
    fn each_table_is_updated_with_the_others_opinion() {
        let mut learner = DoubleQLearning::new(agent(&[1.0, 0.0, 2.0, 4.0]), QTable::new(vec![3.0, 0.0, 8.0, 6.0], 2));
        // The stream's first numbers are 0.636… and 0.269…: Q₂ learns first, then Q₁.
        let mut rng = rng();
        // Q₂ prefers action 0, which Q₁ holds worth 2: 3 + 0.5 (-1 + 0.5 · 2 - 3)
        learner.learn([0], 0, -1.0, Next::Truncated([1]), &mut rng);
        assert_eq!((learner.agent.table.values()[0], learner.second.values()[0]), (1.0, 1.5));
        // Q₁ prefers action 1, which Q₂ holds worth 6: 1 + 0.5 (-1 + 0.5 · 6 - 1)
        learner.learn([0], 0, -1.0, Next::Truncated([1]), &mut rng);
        assert_eq!((learner.agent.table.values()[0], learner.second.values()[0]), (1.5, 1.5));
    }

    #[test]
    fn actions_follow_the_sum() {
        let mut learner = DoubleQLearning::new(agent(&[1.0, 0.0]), QTable::new(vec![0.0, 2.0], 2));
        assert_eq!(learner.first_action([0], &mut rng()), 1);
    }
}
