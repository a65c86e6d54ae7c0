//! Sarsa: on-policy temporal-difference control (Rummery & Niranjan, 1994; Sutton & Barto, equation 6.7).

use super::{Agent, Policy, Rule, StepSize};
use crate::random::Draw;
use crate::world::Next;

/// Q(S, A) ← Q(S, A) + α [R + γ Q(S′, A′) - Q(S, A)], A′ chosen before the update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sarsa;

impl<const N: usize, R, P, A> Rule<R, Agent<N, P, A>> for Sarsa
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
        let Some((there, next_action)) = agent.follow(next, draw) else {
            agent.end(here, action, reward);
            return 0;
        };
        let target = reward + agent.discount * agent.value(there, next_action);
        agent.move_towards(here, action, target);
        next_action
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Learner;
    use crate::learners::Control;
    use crate::learners::example::{agent, draw};

    #[test]
    fn one_update_by_hand() {
        let mut learner = Control { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: Sarsa };
        // 1 + 0.5 (-1 + 0.5 · 3 - 1)
        assert_eq!(learner.learn([0], 0, -1.0, Next::Goes([1]), &mut draw()), 1);
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 2.0, 3.0]);
    }

    #[test]
    fn a_time_out_bootstraps_and_a_terminal_state_does_not() {
        let mut learner = Control { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: Sarsa };
        learner.learn([0], 0, -1.0, Next::TimedOut([1]), &mut draw());
        learner.learn([1], 0, -1.0, Next::Terminal, &mut draw());
        // 2 + 0.5 (-1 - 2)
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 0.5, 3.0]);
    }
}
