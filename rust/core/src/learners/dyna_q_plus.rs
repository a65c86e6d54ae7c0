//! Dyna-Q+: Dyna-Q that grows curious of what it has not tried for long (Sutton, 1990; Sutton & Barto, section 8.3).

use super::common::single_row;
use super::common::{Agent, Model, ModelEntry, UpdateRule};
use crate::random::Rng;
use crate::tasks::Next;

/// Dyna-Q, whose planning adds κ √τ to a reward, τ being the steps since the pair was last tried. Actions that were
/// never tried are considered as well: they are taken to lead back with a reward of zero (the book's footnote), and τ
/// counts from the run's beginning.
#[derive(Clone, Debug, PartialEq)]
pub struct DynaQPlus {
    /// What followed each pair the last time.
    pub model: Model,
    /// n: how many updates follow each step.
    pub planning_steps: u32,
    /// κ.
    pub time_weight: f64,
    now: u64,
    last_tried: Vec<u64>,
}

impl DynaQPlus {
    /// A rule for an agent that has tried nothing yet.
    pub fn new(model: Model, planning_steps: u32, time_weight: f64) -> Self {
        let last_tried = vec![0; model.pairs()];
        Self { model, planning_steps, time_weight, now: 0, last_tried }
    }
}

impl<R: Copy + AsRef<[u32]>> UpdateRule<R, Agent> for DynaQPlus {
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
        self.now += 1;
        self.last_tried[agent.table.weight_index(row, action)] = self.now;
        agent.update_from_entry(row, action, outcome);
        self.model.remember(row, action, outcome);
        for _ in 0..self.planning_steps {
            let row = self.model.sample_state(rng);
            let action = rng.integers(agent.table.num_actions() as u32) as usize;
            let ModelEntry { reward, next } =
                self.model.outcome(row, action).unwrap_or(ModelEntry { reward: 0.0, next: Some(row) });
            let elapsed = (self.now - self.last_tried[agent.table.weight_index(row, action)]) as f64;
            let curious = reward + self.time_weight * elapsed.sqrt();
            agent.update_from_entry(row, action, ModelEntry { reward: curious, next });
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
    fn what_was_not_tried_for_long_gains() {
        let rule = DynaQPlus::new(Model::new(1, 2), 64, 1.0);
        let mut learner = TdLearner { agent: agent(&[0.0, 0.0]), rule };
        learner.learn([0], 0, 0.0, Next::Terminal, &mut rng());
        // Action 1, never tried, is taken to lead back with κ √1: its value v = 1 + 0.5 v, so 2 in the end.
        let &[tried, untried] = learner.agent.table.values() else { unreachable!("two actions") };
        assert_eq!(tried, 0.0);
        assert!((untried - 2.0).abs() < 1e-3);
    }
}
