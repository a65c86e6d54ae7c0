//! Dyna-Q: Q-learning that also learns from a model (R. Sutton, 1990; Sutton & Barto, the box in section 8.2).

use super::{DynaModel, Model, ModelEntry, Planning, single_row};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, row_work};
use crate::memory::{AllocationError, RunMemory};
use crate::random::Rng;
use crate::tasks::Next;

/// At every step:
///
/// 1. Q(S, A) ← Q(S, A) + α [R + γ maxₐ Q(S′, a) - Q(S, A)];
/// 2. Model(S, A) ← R, S′;
/// 3. n times: S ← a random visited state, A ← a random action tried in S, R, S′ ← Model(S, A), and update 1.
///
/// With a [`StochasticModel`](super::StochasticModel), R, S′ are sampled from the outcomes observed for S, A. A state
/// must have one active row.
#[derive(Clone, Debug, PartialEq)]
pub struct DynaQ<M = Model> {
    /// The model.
    pub model: M,
    /// The number of planning updates per step, n.
    pub planning_steps: u32,
    /// The planning of the last step.
    planning: Planning,
}

impl<M: DynaModel> DynaQ<M> {
    /// An update rule before the first step.
    pub fn new(model: M, planning_steps: u32) -> Self {
        Self { model, planning_steps, planning: Planning::default() }
    }
}

impl<R: Copy + ActiveFeatures, M: DynaModel> UpdateRule<R, Agent> for DynaQ<M> {
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
        agent.update_from_transition(row, action, entry.reward, entry.next);
        self.model.record(row, action, entry);
        self.planning.begin(self.planning_steps);
        self.resume(agent, next, rng)
    }

    #[inline]
    fn work(&self, _row_work: u64) -> u64 {
        self.planning.work()
    }

    fn reserve(&mut self, _agent: &mut Agent, work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        self.model.reserve(work, memory)
    }

    #[inline]
    fn is_unfinished(&self) -> bool {
        self.planning.is_unfinished()
    }

    #[inline]
    fn resume(&mut self, agent: &mut Agent, next: Next<R>, rng: &mut impl Rng) -> usize {
        for _ in 0..self.planning.take(row_work(self.model.tried().num_actions()) + self.model.work()) {
            let row = self.model.tried().sample_state(rng);
            let action = self.model.tried().sample_action(row, rng);
            if let Some(ModelEntry { reward, next }) = self.model.sample(row, action, rng) {
                agent.update_from_transition(row, action, reward, next);
            }
        }
        if self.planning.is_unfinished() { 0 } else { agent.next_action(next, rng) }
    }

    fn end_episode(&mut self, _agent: &mut Agent) {
        self.planning.clear();
    }

    fn persist(&mut self, _shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        (&mut self.model, &mut self.planning).persist(checkpoint)?;
        checkpoint.check(!self.planning.is_unfinished() || !self.model.tried().is_empty(), "number of planning updates")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StopFlag;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, StochasticModel, TdLearner};
    use crate::memory::{MemoryRoom, RunMemory};

    #[test]
    fn the_work_of_planning_grows_with_the_logarithm_of_the_outcomes() {
        let rule = DynaQ::new(StochasticModel::new(1, 2, &StopFlag::new()).expect("two pairs"), 10);
        let mut learner = TdLearner { agent: agent(&[0.0; 2]), rule };
        let mut memory = RunMemory::new(MemoryRoom::unlimited());
        Learner::<[u32; 1]>::reserve(&mut learner, 1024, &mut memory).expect("a few outcomes");
        let mut work = Vec::new();
        for step in 1..=1024 {
            learner.learn([0], 0, f64::from(step), Next::Terminal, &mut rng());
            work.push(Learner::<[u32; 1]>::work(&learner));
        }
        assert_eq!([work[0], work[1], work[1023]], [11, 22, 121]);
    }

    #[test]
    fn planning_repeats_the_only_transition() {
        let rule = DynaQ::new(Model::new(2, 2, &StopFlag::new()).expect("a few pairs"), 2);
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule };
        learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng());
        // Three updates with α = 0.5 towards -1 + 0.5 · 3: 0.75, 0.625, 0.5625
        assert_eq!(learner.agent.table.values(), [0.5625, 0.0, 2.0, 3.0]);
    }
}
