//! True online Sarsa(λ), with dutch traces (H. van Seijen et al., 2016; Sutton & Barto, the box in section 12.7).

use super::{EligibilityTraces, Traces, has_traces};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule};
use crate::random::Rng;
use crate::tasks::Next;

/// With the weights w (the Q table), the traces z, the features x of (S, A), Q = wᵀx and Q′ = wᵀx′:
///
/// - δ = R + γ Q′ - Q
/// - z ← γλ z + (1 - αγλ zᵀx) x
/// - w ← w + α (δ + Q - Qₒ) z - α (Q - Qₒ) x
/// - Qₒ ← Q′
///
/// If each weight has a step size αᵢ, as with a Fourier basis, α zᵀx is Σᵢ αᵢ zᵢ xᵢ and the update of wᵢ has αᵢ: the
/// equations of the online λ-return with a diagonal matrix in place of α.
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
        let (constants, pair) = ((self.trace_decay, self.q_old), (state, action));
        let (next_action, next_value) = if R::WEIGHTED {
            learn(&mut self.traces.dense, constants, agent, pair, (reward, next), rng)
        } else {
            learn(&mut self.traces, constants, agent, pair, (reward, next), rng)
        };
        self.q_old = next_value;
        next_action
    }

    has_traces!();

    fn end_episode(&mut self, agent: &mut Agent) {
        self.q_old = 0.0;
        self.traces.clear_of::<R>(&mut agent.table);
    }

    fn persist(&mut self, shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.traces.persist_of::<R>(shape, checkpoint)?;
        self.q_old.persist(checkpoint)
    }
}

/// The step of true online Sarsa(λ) with any traces, given λ and Qₒ. Returns A′ and Q′.
#[inline(always)]
fn learn<R: Copy + ActiveFeatures>(
    traces: &mut impl EligibilityTraces,
    (trace_decay, q_old): (f64, f64),
    agent: &mut Agent,
    (state, action): (R, usize),
    (reward, next): (f64, Next<R>),
    rng: &mut impl Rng,
) -> (usize, f64) {
    traces.begin_step(&mut agent.table);
    let (next_action, next_value) = traces.sample_next(agent, next, rng).unwrap_or((0, 0.0));
    let value = traces.value(&agent.table, &state, action);
    let error = reward + agent.discount * next_value - value;
    let change = value - q_old;
    let decay = agent.discount * trace_decay;

    let increment = 1.0 - traces.overlap(&agent.table, &agent.learning_rate, (&state, action), decay);
    traces.decay(&mut agent.table, decay);
    traces.add(&mut agent.table, (&state, action), increment);
    agent.table.check_finite(error);
    traces.apply_td_error(&mut agent.table, &agent.learning_rate, error + change);
    traces.subtract(&mut agent.table, &agent.learning_rate, (&state, action), change);
    (next_action, next_value)
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
