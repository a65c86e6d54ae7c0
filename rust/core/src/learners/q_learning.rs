//! Q-learning: off-policy temporal-difference control (Watkins, 1989; Sutton & Barto, equation 6.8).

use super::{Agent, Policy, Rule, StepSize};
use crate::random::Draw;
use crate::table::maximum;
use crate::world::Next;

/// Q(S, A) ← Q(S, A) + α [R + γ maxₐ Q(S′, a) - Q(S, A)], evaluated from the left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QLearning;

impl<const N: usize, R, P, A> Rule<R, Agent<N, P, A>> for QLearning
where
    R: Copy + AsRef<[u32]>,
    P: Policy,
    A: StepSize,
{
    #[inline]
    fn learn(
        &mut self,
        agent: &mut Agent<N, P, A>,
        here: R,
        action: usize,
        reward: f64,
        next: Next<R>,
        draw: &mut impl Draw,
    ) -> usize {
        // Each case is written out: shared, the article's run would lose a twentieth of its speed.
        match next {
            Next::Goes(there) => {
                let target = reward + agent.discount * maximum(agent.table.read(there.as_ref()));
                agent.move_towards(here, action, target);
                agent.choose(there, draw)
            }
            Next::TimedOut(there) => {
                let target = reward + agent.discount * maximum(agent.table.read(there.as_ref()));
                agent.move_towards(here, action, target);
                0
            }
            Next::Terminal => {
                agent.end(here, action, reward);
                0
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Learner;
    use crate::learners::example::{agent, draw};
    use crate::learners::{Control, Rate, Schedule};

    #[test]
    fn one_update_by_hand() {
        let mut learner = Control { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: QLearning };
        // 1 + 0.5 (-1 + 0.5 · 3 - 1)
        assert_eq!(learner.learn([0], 0, -1.0, Next::Goes([1]), &mut draw()), 1);
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 2.0, 3.0]);
        // 3 + 0.5 (-1 - 3)
        learner.learn([1], 1, -1.0, Next::Terminal, &mut draw());
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 2.0, 1.0]);
    }

    #[test]
    fn rows_lit_together_share_an_update() {
        let mut agent = agent(&[1.0, 0.0, 2.0, 3.0, 0.0, 4.0]);
        agent.learning_rate = Rate::scheduled(Schedule::constant(0.5), 2);
        agent.discount = 1.0;
        let mut learner = Control { agent, rule: QLearning };
        // Q(S, 0) = 1 + 2, max Q(S', ·) = 3 + 4: each weight moves by 0.5/2 (-2 + 7 - 3).
        learner.learn([0, 1], 0, -2.0, Next::Goes([1, 2]), &mut draw());
        assert_eq!(learner.agent.table.values(), [1.5, 0.0, 2.5, 3.0, 0.0, 4.0]);
    }
}
