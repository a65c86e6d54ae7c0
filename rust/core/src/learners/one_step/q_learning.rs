//! Q-learning: off-policy temporal-difference control (C. Watkins, 1989; Sutton & Barto, equation 6.8).

use crate::features::ActiveFeatures;
use crate::learners::{Agent, UpdateRule, learn_borrowed};
use crate::numeric::maximum;
use crate::policies::Policy;
use crate::random::Rng;
use crate::schedules::StepSize;
use crate::tasks::Next;

/// Q(S, A) ← Q(S, A) + α [R + γ maxₐ Q(S′, a) - Q(S, A)].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QLearning;

impl<const N: usize, R, P, A> UpdateRule<R, Agent<N, P, A>> for QLearning
where
    R: Copy + ActiveFeatures,
    P: Policy,
    A: StepSize,
{
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn learn(
        &mut self,
        agent: &mut Agent<N, P, A>,
        state: R,
        action: usize,
        reward: f64,
        next: Next<R>,
        rng: &mut impl Rng,
    ) -> usize {
        // The cases repeat the target, because shared code would slow the specialized run down by a twentieth.
        match next {
            Next::NonTerminal(next_state) => {
                let target = reward + agent.discount * maximum(agent.action_values(next_state));
                agent.update(state, action, target);
                agent.choose(next_state, rng)
            }
            Next::Truncated(next_state) => {
                let target = reward + agent.discount * maximum(agent.action_values(next_state));
                agent.update(state, action, target);
                0
            }
            Next::Terminal => {
                agent.update_terminal(state, action, reward);
                0
            }
        }
    }

    learn_borrowed!(Agent<N, P, A>);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::{agent, rng};
    use crate::learners::{Learner, TdLearner};
    use crate::schedules::{LearningRate, Schedule};

    #[test]
    fn one_update_by_hand() {
        let mut learner = TdLearner { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: QLearning };
        // 1 + 0.5 (-1 + 0.5 · 3 - 1)
        assert_eq!(learner.learn([0], 0, -1.0, Next::NonTerminal([1]), &mut rng()), 1);
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 2.0, 3.0]);
        // 3 + 0.5 (-1 - 3)
        learner.learn([1], 1, -1.0, Next::Terminal, &mut rng());
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 2.0, 1.0]);
    }

    #[test]
    fn active_rows_share_an_update() {
        let mut agent = agent(&[1.0, 0.0, 2.0, 3.0, 0.0, 4.0]);
        agent.learning_rate = LearningRate::scheduled(Schedule::constant(0.5), 2);
        agent.discount = 1.0;
        let mut learner = TdLearner { agent, rule: QLearning };
        // Q(S, 0) = 1 + 2, max Q(S', ·) = 3 + 4: each weight moves by 0.5/2 (-2 + 7 - 3).
        learner.learn([0, 1], 0, -2.0, Next::NonTerminal([1, 2]), &mut rng());
        assert_eq!(learner.agent.table.values(), [1.5, 0.0, 2.5, 3.0, 0.0, 4.0]);
    }
}
