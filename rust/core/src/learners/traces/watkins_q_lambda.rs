//! Watkins's Q(λ) (C. Watkins, 1989; Sutton & Barto, section 12.10, and the box in section 7.6 of the first edition).

use super::{EligibilityTraces, TraceKind, Traces, has_traces};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, masked_values};
use crate::numeric::maximum;
use crate::policies::{Policy, assert_takes};
use crate::random::Rng;
use crate::tasks::Next;

/// With the weights w (the Q table) and the traces z, after z has changed for the visit of (S, A):
///
/// - δ = R + γ maxₐ Q(S′, a) - Q(S, A)
/// - w ← w + α δ z
/// - z ← γλ z if A′ is greedy, otherwise z ← 0
#[derive(Clone, Debug, PartialEq)]
pub struct WatkinsQLambda {
    /// The traces z.
    pub traces: Traces,
    /// The effect of a visit on the traces.
    pub kind: TraceKind,
    /// The trace decay λ.
    pub trace_decay: f64,
}

impl<R: Copy + ActiveFeatures> UpdateRule<R, Agent> for WatkinsQLambda {
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

/// The step of Watkins's Q(λ) with any traces, given their kind and λ.
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
    let (next_action, target, greedy) = match next {
        Next::NonTerminal(next_state) | Next::Truncated(next_state) => {
            assert_takes(&agent.policy, &next_state);
            let values = traces.action_values(&mut agent.table, next_state);
            let values = masked_values::<0>(&mut agent.masks, next_state.as_ref(), values);
            let next_action = agent.policy.choose_in(next_state.as_ref(), values, rng);
            let largest = maximum(values);
            // An action that ties for the maximum is greedy, even if it was chosen by exploring.
            (next_action, reward + agent.discount * largest, values[next_action] == largest)
        }
        Next::Terminal => (0, reward, false),
    };
    let error = target - value;
    agent.table.check_finite(error);
    if greedy {
        let decay = agent.discount * trace_decay;
        traces.apply_td_error_and_decay(&mut agent.table, &agent.learning_rate, error, decay);
    } else {
        traces.apply_td_error(&mut agent.table, &agent.learning_rate, error);
        traces.clear(&mut agent.table);
    }
    next_action
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StopFlag;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};
    use crate::policies::{AnyPolicy, TieBreaking};
    use crate::schedules::Schedule;

    fn learner(epsilon: f64) -> TdLearner<WatkinsQLambda> {
        let mut agent = agent(&[1.0, 0.0, 2.0, 3.0]);
        agent.policy = AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(epsilon), ties: TieBreaking::First };
        let rule = WatkinsQLambda {
            traces: Traces::new(4, 0.0, &StopFlag::new()).expect("a few weights"),
            kind: TraceKind::Replacing,
            trace_decay: 0.5,
        };
        TdLearner { agent, rule }
    }

    #[test]
    fn an_error_updates_earlier_pairs_while_actions_are_greedy() {
        let mut learner = learner(0.0);
        assert_eq!(learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng()), 1);
        // δ = -1 - 3, and the first pair's trace is 1/4
        learner.learn([1], 1, -1.0, Next::Terminal, &mut rng());
        Learner::<[u32; 1]>::complete_tables(&mut learner);
        assert_eq!(learner.agent.table.values(), [0.25, 0.0, 2.0, 1.0]);
    }

    #[test]
    fn a_non_greedy_action_clears_the_traces() {
        let mut learner = learner(1.0);
        let mut rng = rng();
        while learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng) == 1 {
            assert!(!learner.rule.traces.is_empty());
        }
        assert!(learner.rule.traces.is_empty());
    }
}
