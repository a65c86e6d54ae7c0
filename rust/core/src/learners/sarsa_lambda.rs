//! Sarsa(λ) (Rummery & Niranjan, 1994; Sutton & Barto, the box in section 12.7).

use super::{Agent, Rule, Trace, Traces};
use crate::random::Draw;
use crate::world::Next;

/// δ = R + γ Q(S′, A′) - Q(S, A); w ← w + α δ z; z ← γλ z. A visit marks the traces of its rows first.
#[derive(Clone, Debug, PartialEq)]
pub struct SarsaLambda {
    /// z.
    pub traces: Traces,
    /// How a visit marks it.
    pub kind: Trace,
    /// λ.
    pub trace_decay: f64,
}

impl<R: Copy + AsRef<[u32]>> Rule<R, Agent> for SarsaLambda {
    #[inline]
    fn learn(
        &mut self,
        agent: &mut Agent,
        here: R,
        action: usize,
        reward: f64,
        next: Next<R>,
        draw: &mut impl Draw,
    ) -> usize {
        agent.visit(here, action);
        self.traces.visit(self.kind, &agent.table, here.as_ref(), action);
        let value = agent.value(here, action);
        let (next_action, target) = match agent.follow(next, draw) {
            Some((there, next_action)) => (next_action, reward + agent.discount * agent.value(there, next_action)),
            None => (0, reward),
        };
        let error = target - value;
        agent.table.watch(error);
        let decay = agent.discount * self.trace_decay;
        self.traces.correct_and_decay(&mut agent.table, &agent.learning_rate, error, decay);
        next_action
    }

    fn end_episode(&mut self) {
        self.traces.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Learner;
    use crate::learners::Control;
    use crate::learners::example::{agent, draw};

    #[test]
    fn an_error_reaches_back_along_the_traces() {
        let rule = SarsaLambda { traces: Traces::new(4, 0.0), kind: Trace::Accumulating, trace_decay: 0.5 };
        let mut learner = Control { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule };
        // δ = -1 + 0.5 · 3 - 1
        assert_eq!(learner.learn([0], 0, -1.0, Next::Goes([1]), &mut draw()), 1);
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 2.0, 3.0]);
        // δ = -1 - 3, and the first pair's trace is 1/4
        learner.learn([1], 1, -1.0, Next::Terminal, &mut draw());
        assert_eq!(learner.agent.table.values(), [0.25, 0.0, 2.0, 1.0]);
    }
}
