//! Dyna-Q: Q-learning that also learns from what it remembers (Sutton, 1990; Sutton & Barto, the box in section 8.2).

use super::{Agent, Model, Outcome, Rule};
use crate::random::Draw;
use crate::table::maximum;
use crate::world::Next;

/// After every step: Q-learning's update, the model, then the same update for pairs drawn from the model. A state is one
/// row of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct DynaQ {
    /// What followed each pair the last time.
    pub model: Model,
    /// n: how many updates follow each step.
    pub planning_steps: u32,
}

impl Agent {
    /// Q(S, A) ← Q(S, A) + α [R + γ maxₐ Q(S′, a) - Q(S, A)] of a lone row.
    pub(crate) fn learn_outcome(&mut self, row: u32, action: usize, outcome: Outcome) {
        match outcome.next {
            Some(next) => {
                let target = outcome.reward + self.discount * maximum(self.table.row(next));
                self.move_towards([row], action, target);
            }
            None => self.end([row], action, outcome.reward),
        }
    }
}

impl Outcome {
    /// What a step has brought; a time-out leads on.
    ///
    /// # Panics
    /// If a state is not one row.
    pub(crate) fn new<R: AsRef<[u32]>>(reward: f64, next: &Next<R>) -> Self {
        let next = match next {
            Next::Goes(there) | Next::TimedOut(there) => Some(lone(there)),
            Next::Terminal => None,
        };
        Self { reward, next }
    }
}

/// The row of a state that is one row.
pub(crate) fn lone(rows: &impl AsRef<[u32]>) -> u32 {
    let &[row] = rows.as_ref() else { unreachable!("a model of pairs needs a table, not tile coding") };
    row
}

impl<R: Copy + AsRef<[u32]>> Rule<R, Agent> for DynaQ {
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
        let (row, outcome) = (lone(&here), Outcome::new(reward, &next));
        agent.learn_outcome(row, action, outcome);
        self.model.remember(row, action, outcome);
        for _ in 0..self.planning_steps {
            let row = self.model.any_row(draw);
            let action = self.model.any_action(row, draw);
            if let Some(outcome) = self.model.outcome(row, action) {
                agent.learn_outcome(row, action, outcome);
            }
        }
        agent.go_on(next, draw)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Learner;
    use crate::learners::Control;
    use crate::learners::example::{agent, draw};

    #[test]
    fn planning_repeats_the_only_thing_that_happened() {
        let rule = DynaQ { model: Model::new(2, 2), planning_steps: 2 };
        let mut learner = Control { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule };
        learner.learn([0], 0, -1.0, Next::Goes([1]), &mut draw());
        // Three times half the way to -1 + 0.5 · 3: 0.75, 0.625, 0.5625
        assert_eq!(learner.agent.table.values(), [0.5625, 0.0, 2.0, 3.0]);
    }
}
