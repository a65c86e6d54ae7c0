//! True online Sarsa(λ), with dutch traces (H. van Seijen et al., 2016; Sutton & Barto, the box in section 12.7).

use super::Traces;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::{ActiveFeatures, assert_binary};
use crate::learners::{Agent, UpdateRule, VALUES_PER_WORK};
use crate::memory::{AllocationError, RunMemory};
use crate::random::Rng;
use crate::schedules::StepSize;
use crate::tasks::Next;

/// With the weights w (the Q table), the traces z, the binary features x of (S, A), Q = wᵀx and Q′ = wᵀx′:
///
/// - δ = R + γ Q′ - Q
/// - z ← γλ z + (1 - αγλ zᵀx) x
/// - w ← w + α (δ + Q - Qₒ) z - α (Q - Qₒ) x
/// - Qₒ ← Q′
#[derive(Clone, Debug, PartialEq)]
pub struct TrueOnlineSarsaLambda {
    /// The dutch traces z.
    pub traces: Traces,
    /// The trace decay λ.
    pub trace_decay: f64,
    /// Qₒ: Q′ of the previous step.
    q_old: f64,
}

impl TrueOnlineSarsaLambda {
    /// An update rule before the first step.
    pub fn new(traces: Traces, trace_decay: f64) -> Self {
        Self { traces, trace_decay, q_old: 0.0 }
    }

    /// Qₒ: Q′ of the previous step.
    pub fn q_old(&self) -> f64 {
        self.q_old
    }
}

impl<R: Copy + ActiveFeatures> UpdateRule<R, Agent> for TrueOnlineSarsaLambda {
    const HAS_VECTOR_PASSES: bool = true;

    #[inline(always)]
    fn learn(
        &mut self,
        agent: &mut Agent,
        state: R,
        action: usize,
        reward: f64,
        next: Next<R>,
        rng: &mut impl Rng,
    ) -> usize {
        assert_binary::<R>();
        let (traces, rows) = (&mut self.traces, state.as_ref());
        traces.begin_step(&mut agent.table);
        let (next_action, next_value) = traces.sample_next(agent, next, rng).unwrap_or((0, 0.0));
        let value = traces.value(&agent.table, rows, action);
        let error = reward + agent.discount * next_value - value;
        let change = value - self.q_old;
        // The algorithm needs one step size for all weights, so visit counts are not supported.
        let step_size = agent.learning_rate.at(0);
        let decay = agent.discount * self.trace_decay;

        let increment = 1.0 - step_size * decay * traces.sum(&agent.table, rows, action);
        traces.decay(&mut agent.table, decay);
        traces.update(&mut agent.table, state, action, |trace| trace + increment);
        agent.table.check_finite(error);
        traces.apply_td_error(&mut agent.table, &agent.learning_rate, error + change);
        traces.subtract(&mut agent.table, rows, action, step_size * change);
        self.q_old = next_value;
        next_action
    }

    #[inline]
    fn work(&self, row_work: u64) -> u64 {
        row_work + self.traces.pass_len() as u64 / VALUES_PER_WORK
    }

    fn end_episode(&mut self, agent: &mut Agent) {
        self.q_old = 0.0;
        self.traces.clear(&mut agent.table);
    }

    fn complete_tables(&mut self, agent: &mut Agent) {
        self.traces.complete_table(&mut agent.table);
    }

    fn reserve(&mut self, agent: &mut Agent, _work: u64, _memory: &mut RunMemory) -> Result<(), AllocationError> {
        self.traces.reserve(&mut agent.table)
    }

    fn persist(&mut self, _shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.traces.persist(checkpoint)?;
        self.q_old.persist(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StopFlag;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};

    fn learner(values: &[f64]) -> TdLearner<TrueOnlineSarsaLambda> {
        TdLearner {
            agent: agent(values),
            rule: TrueOnlineSarsaLambda::new(
                Traces::new(values.len(), 0.0, &StopFlag::new()).expect("a few weights"),
                0.5,
            ),
        }
    }

    #[test]
    fn two_updates_by_hand() {
        let mut learner = learner(&[1.0, 0.0, 2.0, 3.0]);
        // z = 1; δ = -1 + 0.5 · 3 - 1; 1 + 0.5 (δ + 1 - 0) - 0.5 (1 - 0)
        learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng());
        Learner::<[u32; 1]>::complete_tables(&mut learner);
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 2.0, 3.0]);
        // z = 1/4 and 1, Q = Q_old = 3; δ = -1 - 3
        learner.learn([1], 1, -1.0, Next::Terminal, &mut rng());
        Learner::<[u32; 1]>::complete_tables(&mut learner);
        assert_eq!(learner.agent.table.values(), [0.25, 0.0, 2.0, 1.0]);
    }

    #[test]
    fn a_second_visit_adds_less_than_one() {
        let mut learner = learner(&[0.0, 0.0]);
        for _ in 0..2 {
            learner.learn([0], 0, 0.0, Next::NonTerminal([0]), &mut rng());
        }
        // 1/4 + 1 - 0.5 · 0.25 · 1
        assert_eq!(learner.rule.traces.get(0), 1.125);
    }
}
