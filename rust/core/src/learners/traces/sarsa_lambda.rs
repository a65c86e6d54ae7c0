//! Sarsa(λ) (G. Rummery and M. Niranjan, 1994; Sutton & Barto, the box in section 12.7).

use super::{EligibilityTraces, TraceKind, Traces, has_traces};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule};
use crate::random::Rng;
use crate::tasks::Next;

/// With the weights w (the Q table) and the traces z, after z has changed for the visit of (S, A):
///
/// - δ = R + γ Q(S′, A′) - Q(S, A)
/// - w ← w + α δ z
/// - z ← γλ z
#[derive(Clone, Debug, PartialEq)]
pub struct SarsaLambda {
    /// The traces z.
    pub traces: Traces,
    /// The effect of a visit on the traces.
    pub kind: TraceKind,
    /// The trace decay λ.
    pub trace_decay: f64,
}

impl<R: Copy + ActiveFeatures> UpdateRule<R, Agent> for SarsaLambda {
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
        agent.visit(state, action);
        let (options, pair) = ((self.kind, self.trace_decay), (state, action));
        if R::WEIGHTED {
            learn(&mut self.traces.dense, options, agent, pair, (reward, next), rng)
        } else {
            learn(&mut self.traces, options, agent, pair, (reward, next), rng)
        }
    }

    has_traces!();

    fn end_episode(&mut self, agent: &mut Agent) {
        self.traces.clear_of::<R>(&mut agent.table);
    }

    fn persist(&mut self, shape: (usize, usize), checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.traces.persist_of::<R>(shape, checkpoint)
    }
}

/// The step of Sarsa(λ) with any traces, given their kind and λ.
#[inline(always)]
fn learn<R: Copy + ActiveFeatures>(
    traces: &mut impl EligibilityTraces,
    (kind, trace_decay): (TraceKind, f64),
    agent: &mut Agent,
    (state, action): (R, usize),
    (reward, next): (f64, Next<R>),
    rng: &mut impl Rng,
) -> usize {
    traces.begin_step(&mut agent.table);
    let value = traces.visit(kind, &mut agent.table, state, action);
    let (next_action, target) = match traces.sample_next(agent, next, rng) {
        Some((next_action, next_value)) => (next_action, reward + agent.discount * next_value),
        None => (0, reward),
    };
    let error = target - value;
    agent.table.check_finite(error);
    let decay = agent.discount * trace_decay;
    traces.apply_td_error_and_decay(&mut agent.table, &agent.learning_rate, error, decay);
    next_action
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StopFlag;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};

    #[test]
    fn an_error_updates_earlier_pairs_along_the_traces() {
        let rule = SarsaLambda {
            traces: Traces::new(4, 0.0, &StopFlag::new()).expect("a few weights"),
            kind: TraceKind::Accumulating,
            trace_decay: 0.5,
        };
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule };
        // δ = -1 + 0.5 · 3 - 1
        assert_eq!(learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng()), 1);
        Learner::<[u32; 1]>::complete_tables(&mut learner);
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 2.0, 3.0]);
        // δ = -1 - 3, and the first pair's trace is 1/4
        learner.learn([1], 1, -1.0, Next::Terminal, &mut rng());
        Learner::<[u32; 1]>::complete_tables(&mut learner);
        assert_eq!(learner.agent.table.values(), [0.25, 0.0, 2.0, 1.0]);
    }
}
