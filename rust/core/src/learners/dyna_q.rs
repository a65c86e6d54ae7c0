//! Dyna-Q: Q-learning that also learns from what it remembers (Sutton, 1990; Sutton & Barto, the box in section 8.2).

use super::common::single_row;
use super::common::{Agent, Model, ModelEntry, UpdateRule};
use crate::random::Rng;

use crate::tasks::Next;

/// After every step: Q-learning's update, the model, then the same update for pairs drawn from the model. A state is one
/// row of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct DynaQ {
    /// What followed each pair the last time.
    pub model: Model,
    /// n: how many updates follow each step.
    pub planning_steps: u32,
}

impl<R: Copy + AsRef<[u32]>> UpdateRule<R, Agent> for DynaQ {
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
        let (row, outcome) = (single_row(&state), ModelEntry::new(reward, &next));
        agent.update_from_entry(row, action, outcome);
        self.model.remember(row, action, outcome);
        for _ in 0..self.planning_steps {
            let row = self.model.sample_state(rng);
            let action = self.model.sample_action(row, rng);
            if let Some(outcome) = self.model.outcome(row, action) {
                agent.update_from_entry(row, action, outcome);
            }
        }
        agent.next_action(next, rng)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::common::test_support::{agent, rng};
    use crate::learners::common::{Learner, TdLearner};

    #[test]
    fn planning_repeats_the_only_thing_that_happened() {
        let rule = DynaQ { model: Model::new(2, 2), planning_steps: 2 };
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule };
        learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng());
        // Three times half the way to -1 + 0.5 · 3: 0.75, 0.625, 0.5625
        assert_eq!(learner.agent.table.values(), [0.5625, 0.0, 2.0, 3.0]);
    }
}
