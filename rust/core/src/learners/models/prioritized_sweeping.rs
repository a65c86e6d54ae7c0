//! Prioritized sweeping for a deterministic environment (A. Moore & C. Atkeson, 1993; J. Peng & R. Williams, 1993;
//! Sutton & Barto, the box in section 8.4).

use super::{Model, ModelEntry, Planning, Predecessors, PriorityQueue, single_row};
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, row_work};
use crate::memory::AllocationError;
use crate::numeric::maximum;
use crate::random::Rng;
use crate::tasks::Next;

/// At every step:
///
/// 1. Model(S, A) ← R, S′;
/// 2. P ← |R + γ maxₐ Q(S′, a) - Q(S, A)|; if P > θ, insert S, A into the queue with priority P;
/// 3. n times, while the queue is not empty: take the first pair S, A from it, R, S′ ← Model(S, A),
///    Q(S, A) ← Q(S, A) + α [R + γ maxₐ Q(S′, a) - Q(S, A)], and do 2 for every pair predicted to lead to S.
///
/// A state must have one active row. Pairs of equal priority are taken in the order of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct PrioritizedSweeping {
    model: Model,
    predecessors: Predecessors,
    queue: PriorityQueue,
    /// The maximum number of updates per step, n.
    planning_steps: u32,
    /// The threshold θ: pairs need a higher priority.
    threshold: f64,
    /// The planning of the last step.
    planning: Planning,
    /// The number of updates since the start of the run.
    updates: u64,
}

impl PrioritizedSweeping {
    /// An update rule before the first step.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(
        model: Model,
        planning_steps: u32,
        threshold: f64,
        stop: &StopFlag<'_>,
    ) -> Result<Self, AllocationError> {
        let pairs = model.num_pairs();
        let predecessors = Predecessors::new(pairs / model.num_actions(), pairs, stop)?;
        let queue = PriorityQueue::new(pairs, stop)?;
        let planning = Planning::default();
        Ok(Self { model, predecessors, queue, planning_steps, threshold, planning, updates: 0 })
    }

    /// Makes the remaining updates, or a part of them.
    fn sweep(&mut self, agent: &mut Agent) {
        let Self { model, predecessors, queue, threshold, planning, updates, .. } = self;
        let work = row_work(model.num_actions());
        planning.advance(|| {
            let pair = queue.pop()?;
            *updates += 1;
            let (row, action) = ((pair / model.num_actions()) as u32, pair % model.num_actions());
            if let Some(entry) = model.entry(row, action) {
                agent.update_from_transition(row, action, entry.reward, entry.next);
            }
            let mut done = work;
            let mut predecessor = predecessors.first(row);
            while let Some(found) = predecessor {
                consider(queue, model, agent, (found, *threshold));
                done += work;
                predecessor = predecessors.after(found);
            }
            Some(done)
        });
    }
}

/// Inserts a pair of the model into the queue if its error is larger than the threshold.
#[inline]
fn consider(queue: &mut PriorityQueue, model: &Model, agent: &mut Agent, (pair, threshold): (usize, f64)) {
    let (row, action) = ((pair / model.num_actions()) as u32, pair % model.num_actions());
    let Some(ModelEntry { reward, next }) = model.entry(row, action) else { return };
    let target = match next {
        Some(next) => reward + agent.discount * maximum(agent.action_values([next])),
        None => reward,
    };
    let priority = (target - agent.value([row], action)).abs();
    if priority > threshold {
        queue.insert(pair, priority);
    }
}

impl<R: Copy + ActiveFeatures> UpdateRule<R, Agent> for PrioritizedSweeping {
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
        let pair = agent.table.weight_index(row, action);
        let before = self.model.entry(row, action).and_then(|entry| entry.next);
        if before != entry.next {
            if let Some(before) = before {
                self.predecessors.remove(before, pair);
            }
            if let Some(after) = entry.next {
                self.predecessors.add(after, pair);
            }
        }
        self.model.record(row, action, entry);
        consider(&mut self.queue, &self.model, agent, (pair, self.threshold));
        self.planning.begin(self.planning_steps);
        self.resume(agent, next, rng)
    }

    #[inline]
    fn work(&self, row_work: u64) -> u64 {
        row_work + self.planning.work()
    }

    #[inline]
    fn is_unfinished(&self) -> bool {
        self.planning.is_unfinished()
    }

    fn resume(&mut self, agent: &mut Agent, next: Next<R>, rng: &mut impl Rng) -> usize {
        self.sweep(agent);
        if self.planning.is_unfinished() { 0 } else { agent.next_action(next, rng) }
    }

    fn planning_updates(&self) -> Option<u64> {
        Some(self.updates)
    }

    fn end_episode(&mut self, _agent: &mut Agent) {
        self.planning.clear();
    }

    fn persist(
        &mut self,
        (_, num_actions): (usize, usize),
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        self.model.persist(checkpoint)?;
        self.queue.persist(checkpoint)?;
        (&mut self.planning, &mut self.updates).persist(checkpoint)?;
        if checkpoint.is_restoring() {
            self.predecessors.clear();
            for pair in 0..self.model.num_pairs() {
                let entry = self.model.entry((pair / num_actions) as u32, pair % num_actions);
                if let Some(next) = entry.and_then(|entry| entry.next) {
                    self.predecessors.add(next, pair);
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};

    fn sweeping(planning_steps: u32, threshold: f64) -> PrioritizedSweeping {
        let stop = StopFlag::new();
        let model = Model::new(3, 2, &stop).expect("a few pairs");
        PrioritizedSweeping::new(model, planning_steps, threshold, &stop).expect("a few pairs")
    }

    #[test]
    fn a_reward_is_carried_back_in_one_step() {
        let mut learner = TdLearner { agent: agent(&[0.0; 6]), rule: sweeping(5, 1e-4) };
        learner.learn([0], 0, 0.0, Next::NonTerminal([1]), &mut rng());
        learner.learn([1], 0, 0.0, Next::NonTerminal([2]), &mut rng());
        assert_eq!(learner.agent.table.values(), [0.0; 6]);
        learner.learn([2], 1, 8.0, Next::Terminal, &mut rng());
        // α = γ = 1/2: 8 · 1/2, then 4 · 1/4, then 1 · 1/4.
        assert_eq!(learner.agent.table.values(), [0.25, 0.0, 1.0, 0.0, 0.0, 4.0]);
        assert_eq!(learner.rule.updates, 3);
    }

    #[test]
    fn small_errors_are_left_alone() {
        let mut learner = TdLearner { agent: agent(&[0.0; 6]), rule: sweeping(5, 2.0) };
        learner.learn([0], 0, 0.0, Next::NonTerminal([1]), &mut rng());
        learner.learn([1], 0, 8.0, Next::Terminal, &mut rng());
        assert_eq!(learner.agent.table.values(), [0.0, 0.0, 4.0, 0.0, 0.0, 0.0]);
    }
}
