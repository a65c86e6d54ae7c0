//! True online Sarsa(λ), with dutch traces (van Seijen et al., 2016; Sutton & Barto, the box in section 12.7).

use super::common::{Agent, Traces, UpdateRule};
use crate::random::Rng;
use crate::schedules::StepSize;
use crate::tasks::Next;

/// z ← γλ z + (1 - αγλ zᵀx) x; w ← w + α (δ + Q - Qₒ) z - α (Q - Qₒ) x; Qₒ ← Q′, the old value.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueOnlineSarsaLambda {
    /// z.
    pub traces: Traces,
    /// λ.
    pub trace_decay: f64,
    old: f64,
}

impl TrueOnlineSarsaLambda {
    /// A rule that has seen nothing yet.
    pub fn new(traces: Traces, trace_decay: f64) -> Self {
        Self { traces, trace_decay, old: 0.0 }
    }
}

impl<R: Copy + AsRef<[u32]>> UpdateRule<R, Agent> for TrueOnlineSarsaLambda {
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
        let (traces, rows) = (&mut self.traces, state.as_ref());
        let (next_action, next_value) = match agent.sample_next(next, rng) {
            Some((next_state, next_action)) => (next_action, agent.value(next_state, next_action)),
            None => (0, 0.0),
        };
        let value = agent.value(state, action);
        let error = reward + agent.discount * next_value - value;
        let change = value - self.old;
        // Its step size is the same for every weight: visits do not count.
        let step = agent.learning_rate.at(0);
        let decay = agent.discount * self.trace_decay;

        let uniform = rows.iter().fold(0.0, |sum, &row| sum + traces.get(agent.table.weight_index(row, action)));
        let mark = 1.0 - step * decay * uniform;
        traces.decay(decay);
        for &row in rows {
            traces.update(agent.table.weight_index(row, action), |trace| trace + mark);
        }
        agent.table.check_finite(error);
        traces.apply_td_error(&mut agent.table, &agent.learning_rate, error + change);
        for &row in rows {
            *agent.table.value_mut(row, action) -= step * change;
        }
        self.old = next_value;
        next_action
    }

    fn end_episode(&mut self) {
        self.old = 0.0;
        self.traces.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::common::test_support::{agent, rng};
    use crate::learners::common::{Learner, TdLearner};

    fn learner(values: &[f64]) -> TdLearner<TrueOnlineSarsaLambda> {
        TdLearner { agent: agent(values), rule: TrueOnlineSarsaLambda::new(Traces::new(values.len(), 0.0), 0.5) }
    }

    #[test]
    fn the_first_update_corrects_for_the_old_value_of_zero() {
        let mut learner = learner(&[1.0, 0.0, 2.0, 3.0]);
        // z = 1; δ = -1 + 0.5 · 3 - 1; 1 + 0.5 (δ + 1 - 0) - 0.5 (1 - 0)
        learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng());
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 2.0, 3.0]);
        // z = 1/4 and 1, Q = Q_old = 3; δ = -1 - 3
        learner.learn([1], 1, -1.0, Next::Terminal, &mut rng());
        assert_eq!(learner.agent.table.values(), [0.25, 0.0, 2.0, 1.0]);
    }

    #[test]
    fn a_second_visit_adds_less_than_a_whole_trace() {
        let mut learner = learner(&[0.0, 0.0]);
        for _ in 0..2 {
            learner.learn([0], 0, 0.0, Next::NonTerminal([0]), &mut rng());
        }
        // 1/4 + 1 - 0.5 · 0.25 · 1
        assert_eq!(learner.rule.traces.get(0), 1.125);
    }
}
