//! Dyna-Q+: Dyna-Q with an exploration bonus (R. Sutton, 1990; Sutton & Barto, section 8.3).

use super::{Model, ModelEntry, Planning, single_row};
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, row_work};
use crate::memory::{AllocationError, filled};
use crate::random::Rng;
use crate::tasks::Next;

/// Dyna-Q whose planning updates use the reward R + κ √τ, where τ is the number of steps since the pair was last tried
/// in the environment. Planning considers all available actions of a visited state. An action that was never tried is
/// assumed to lead back to the same state with a reward of 0 (the book's footnote), and its τ counts from the start of
/// the run.
#[derive(Clone, Debug, PartialEq)]
pub struct DynaQPlus {
    /// The model.
    pub model: Model,
    /// The number of planning updates per step, n.
    pub planning_steps: u32,
    /// The weight of the bonus, κ.
    pub time_weight: f64,
    /// The number of steps taken.
    now: u64,
    /// The step at which each pair was last tried.
    last_tried: Vec<u64>,
    /// The planning of the last step.
    planning: Planning,
}

impl DynaQPlus {
    /// An update rule before the first step.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(
        model: Model,
        planning_steps: u32,
        time_weight: f64,
        stop: &StopFlag<'_>,
    ) -> Result<Self, AllocationError> {
        let last_tried = filled(&0, model.num_pairs(), stop)?;
        Ok(Self { model, planning_steps, time_weight, now: 0, last_tried, planning: Planning::default() })
    }
}

impl<R: Copy + ActiveFeatures> UpdateRule<R, Agent> for DynaQPlus {
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
        let (row, entry) = (single_row(&state), ModelEntry::new(reward, &next));
        self.now += 1;
        self.last_tried[self.model.pair(row, action)] = self.now;
        agent.update_from_transition(row, action, entry.reward, entry.next);
        self.model.record(row, action, entry);
        self.planning.begin(self.planning_steps);
        self.resume(agent, next, rng)
    }

    #[inline]
    fn work(&self, _row_work: u64) -> u64 {
        self.planning.work()
    }

    #[inline]
    fn is_unfinished(&self) -> bool {
        self.planning.is_unfinished()
    }

    #[inline]
    fn resume(&mut self, agent: &mut Agent, next: Next<R>, rng: &mut impl Rng) -> usize {
        for _ in 0..self.planning.take(row_work(self.model.num_actions())) {
            let row = self.model.sample_state(rng);
            let action = agent.sample_action([row], rng);
            let ModelEntry { reward, next } =
                self.model.entry(row, action).unwrap_or(ModelEntry { reward: 0.0, next: Some(row) });
            let elapsed = (self.now - self.last_tried[self.model.pair(row, action)]) as f64;
            let reward = reward + self.time_weight * elapsed.sqrt();
            agent.update_from_transition(row, action, reward, next);
        }
        if self.planning.is_unfinished() { 0 } else { agent.next_action(next, rng) }
    }

    fn end_episode(&mut self, _agent: &mut Agent) {
        self.planning.clear();
    }

    fn persist(&mut self, _shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        (&mut self.model, &mut self.planning).persist(checkpoint)?;
        checkpoint.check(!self.planning.is_unfinished() || !self.model.is_empty(), "number of planning updates")?;
        self.now.persist(checkpoint)?;
        self.last_tried.persist(checkpoint)?;
        checkpoint.check(self.last_tried.iter().all(|&step| step <= self.now), "step of a visit")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};

    #[test]
    fn an_action_that_was_not_tried_for_long_gains_value() {
        let rule = DynaQPlus::new(Model::new(1, 2, &StopFlag::new()).expect("a few pairs"), 64, 1.0, &StopFlag::new())
            .expect("a few pairs");
        let mut learner = TdLearner { agent: agent(&[0.0, 0.0]), rule };
        learner.learn([0], 0, 0.0, Next::Terminal, &mut rng());
        // Action 1 was never tried: it is assumed to lead back with κ √1, so its value tends to v = 1 + 0.5 v = 2.
        let &[tried, untried] = learner.agent.table.values() else { unreachable!("two actions") };
        assert_eq!(tried, 0.0);
        assert!((untried - 2.0).abs() < 1e-3);
    }
}
