//! REINFORCE (R. Williams, 1992; Sutton & Barto, the boxes in sections 13.3 and 13.4).

use super::{Critic, PolicyGradientRule};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist, persist_rows};
use crate::features::ActiveRows;
use crate::learners::{Agent, VALUES_PER_WORK};
use crate::memory::{AllocationError, RunMemory, reserve};
use crate::tasks::Next;

/// A state-action pair, and the reward that followed; at the end of the episode its return.
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
/// An episode that its time limit cuts off has the return up to there.
#[derive(Clone, Debug, PartialEq)]
pub struct Reinforce<R> {
    /// The steps of the episode.
    steps: Vec<PastStep<R>>,
    /// The work of the last step.
    work: u64,
}

impl<R: ActiveRows> Reinforce<R> {
    /// Before the first episode.
    #[expect(clippy::new_without_default, reason = "as for the other learners")]
    pub fn new() -> Self {
        Self { steps: Vec::new(), work: 1 }
    }

    /// Learns from the steps of the episode.
    #[inline(never)]
    fn finish(&mut self, agent: &mut Agent, mut critic: Option<&mut Critic>) {
        let mut episode_return = 0.0;
        for step in self.steps.iter_mut().rev() {
            episode_return = step.reward + agent.discount * episode_return;
            step.reward = episode_return;
        }
        let mut power = 1.0;
        for &PastStep { rows, action, reward: episode_return } in &self.steps {
            let mut error = episode_return;
            if let Some(critic) = &mut critic {
                error -= critic.value(rows);
                critic.update(rows, error);
            }
            agent.ascend(rows, action, power * error);
            power *= agent.discount;
        }
        let steps = self.steps.len() as u64;
        self.work += steps * agent.work() + steps / VALUES_PER_WORK;
    }
}

impl<R: ActiveRows> PolicyGradientRule<R> for Reinforce<R> {
    #[inline]
    fn learn(
        &mut self,
        agent: &mut Agent,
        critic: Option<&mut Critic>,
        state: R,
        action: usize,
        reward: f64,
        next: Next<R>,
    ) {
        self.steps.push(PastStep { rows: state, action, reward });
        self.work = agent.work();
        if !matches!(next, Next::NonTerminal(_)) {
            self.finish(agent, critic);
        }
    }

    #[inline]
    fn work(&self, _agent: &Agent) -> u64 {
        self.work
    }

    /// An episode has as many steps as there is work for them.
    fn reserve(&mut self, _shape: (usize, usize), work: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        memory.reserve(&mut self.steps, usize::try_from(work).unwrap_or(usize::MAX).min(1 << 20))
    }

    fn end_episode(&mut self) {
        self.steps.clear();
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
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, PolicyGradientLearner};
    use crate::policies::AnyPolicy;
    use crate::q_table::QTable;

    fn learner(critic: Option<Critic>) -> PolicyGradientLearner<Reinforce<[u32; 1]>> {
        let agent = Agent { policy: AnyPolicy::softmax(1.0, 2), ..agent(&[0.0; 4]) };
        PolicyGradientLearner { agent, critic, rule: Reinforce::new() }
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
        let mut learner = learner(Some(Critic { table: QTable::new(vec![2.0; 4], 2), step_size: 0.25 }));
        learner.learn([0], 0, 4.0, Next::Terminal, &mut rng());
        assert_eq!(learner.agent.table.values(), [0.5, -0.5, 0.0, 0.0]);
        assert_eq!(learner.tables()[1], [2.5, 2.5, 2.0, 2.0]);
    }
}
