//! REINFORCE (R. Williams, 1992; Sutton & Barto, the boxes in sections 13.3 and 13.4).

use super::Critic;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::{ActiveRows, persist_rows};
use crate::learners::{Agent, StepInParts, UpdateRule};
use crate::memory::{AllocationError, RunMemory, reserve};
use crate::q_table::QTable;
use crate::random::Rng;
use crate::tasks::Next;

/// A state-action pair with the reward that followed, which its return replaces at the end of the episode.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PastStep<R> {
    rows: R,
    action: usize,
    reward: f64,
}

/// After an episode, for each of its steps t = 0, 1, …, with the return G from there:
///
/// - δ = G - v̂(Sₜ, w), or G without a baseline
/// - w ← w + αʷ δ ∇v̂(Sₜ, w)
/// - θ ← θ + α γᵗ δ ∇ln π(Aₜ | Sₜ, θ)
///
/// The returns of a truncated episode end at the time limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Reinforce<R> {
    baseline: Option<Critic>,
    /// The steps of the episode. The first `learned` of them have been learned from.
    steps: Vec<PastStep<R>>,
    learned: usize,
    /// γᵗ
    power: f64,
    /// The learning at the end of the episode.
    end: StepInParts,
}

impl<R: ActiveRows> Reinforce<R> {
    /// An update rule before the first episode.
    pub fn new(baseline: Option<Critic>) -> Self {
        Self { baseline, steps: Vec::new(), learned: 0, power: 1.0, end: StepInParts::new() }
    }

    /// Turns the rewards into returns, from the last step backwards.
    fn sum_rewards(&mut self, discount: f64) {
        let mut episode_return = 0.0;
        for step in self.steps.iter_mut().rev() {
            episode_return = step.reward + discount * episode_return;
            step.reward = episode_return;
        }
    }

    /// Learns from the steps of the episode, or from a part of them if there are many.
    #[inline(never)]
    fn update_remaining(&mut self, agent: &mut Agent) {
        let Self { baseline, steps, learned, power, end } = self;
        end.advance(|| {
            let Some(PastStep { rows, action, reward: episode_return }) = steps.get(*learned) else {
                return (0, false);
            };
            let mut error = *episode_return;
            if let Some(critic) = baseline {
                error -= critic.value(rows);
                critic.update(rows, error);
            }
            agent.ascend(rows, *action, *power * error);
            *power *= agent.discount;
            *learned += 1;
            (agent.work_of::<R>(), *learned < steps.len())
        });
    }
}

impl<R: ActiveRows> UpdateRule<R, Agent> for Reinforce<R> {
    const HAS_CRITIC: bool = true;

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
        self.steps.push(PastStep { rows: state, action, reward });
        if !matches!(next, Next::NonTerminal(_)) {
            self.sum_rewards(agent.discount);
            self.update_remaining(agent);
        }
        agent.next_action(next, rng)
    }

    #[inline]
    fn work(&self, row_work: u64) -> u64 {
        row_work + self.end.work()
    }

    fn reserve(&mut self, agent: &mut Agent, work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        let steps = work.div_ceil(agent.work_of::<R>());
        memory.reserve(&mut self.steps, usize::try_from(steps).unwrap_or(usize::MAX).min(1 << 20))
    }

    #[inline]
    fn is_unfinished(&self) -> bool {
        self.end.is_unfinished()
    }

    /// Only the learning at the end of an episode can be unfinished, so there is no next action.
    fn resume(&mut self, agent: &mut Agent, _next: Next<R>, _rng: &mut impl Rng) -> usize {
        self.update_remaining(agent);
        0
    }

    fn second_table(&self) -> Option<&QTable> {
        self.baseline.as_ref().map(|critic| &critic.table)
    }

    fn second_table_mut(&mut self) -> Option<&mut QTable> {
        self.baseline.as_mut().map(|critic| &mut critic.table)
    }

    fn end_episode(&mut self, _agent: &mut Agent) {
        self.steps.clear();
        self.end.clear();
        (self.learned, self.power) = (0, 1.0);
    }

    fn persist(
        &mut self,
        (num_rows, num_actions): (usize, usize),
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        let mut count = self.steps.len() as u64;
        count.persist(checkpoint)?;
        if checkpoint.is_restoring() {
            self.steps.clear();
        }
        for index in 0..count {
            let saved = self.steps.get(index as usize).copied();
            let rows = persist_rows(saved.map(|step| step.rows), num_rows, checkpoint)?;
            let (mut action, mut reward) = saved.map_or((0, 0.0), |step| (step.action, step.reward));
            checkpoint.index(&mut action, num_actions, "action")?;
            reward.persist(checkpoint)?;
            if checkpoint.is_restoring() {
                reserve(&mut self.steps, 1).map_err(|_| CheckpointError::OutOfMemory)?;
                self.steps.push(PastStep { rows, action, reward });
            }
        }
        checkpoint.index(&mut self.learned, self.steps.len() + 1, "number of steps")?;
        (&mut self.power, &mut self.end).persist(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};
    use crate::policies::AnyPolicy;
    use crate::schedules::{LearningRate, Schedule};

    fn learner(critic: Option<Critic>) -> TdLearner<Reinforce<[u32; 1]>> {
        let agent = Agent { policy: AnyPolicy::softmax(1.0, 2), ..agent(&[0.0; 4]) };
        TdLearner { agent, rule: Reinforce::new(critic) }
    }

    #[test]
    fn each_step_learns_from_its_return() {
        let mut learner = learner(None);
        learner.learn([0], 0, 1.0, Next::NonTerminal([1]), &mut rng());
        assert_eq!(learner.agent.table.values(), [0.0; 4]);
        learner.learn([1], 1, 4.0, Next::Terminal, &mut rng());
        // Returns 1 + 0.5 · 4 and 4; then 0.5 · 3 · 0.5 and 0.5 · 0.5 · 4 · 0.5
        assert_eq!(learner.agent.table.values(), [0.75, -0.75, -0.5, 0.5]);
    }

    #[test]
    fn a_baseline_is_subtracted_and_learned() {
        let rate = LearningRate::scheduled(Schedule::constant(0.5), 1);
        let mut learner = learner(Some(Critic::new(QTable::new(vec![2.0; 4], 2), 0.25, &rate)));
        learner.learn([0], 0, 4.0, Next::Terminal, &mut rng());
        assert_eq!(learner.agent.table.values(), [0.5, -0.5, 0.0, 0.0]);
        assert_eq!(learner.tables()[1], [2.5, 2.5, 2.0, 2.0]);
    }
}
