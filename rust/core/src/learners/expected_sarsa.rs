//! Expected Sarsa (van Seijen et al., 2009; Sutton & Barto, equation 6.9).

use super::{Agent, Policy, Rule, StepSize};
use crate::random::Draw;
use crate::world::Next;

/// Q(S, A) ← Q(S, A) + α [R + γ Σₐ π(a | S′) Q(S′, a) - Q(S, A)]. The next action is chosen after the update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedSarsa;

impl<const N: usize, R, P, A> Rule<R, Agent<N, P, A>> for ExpectedSarsa
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
        match next {
            Next::Goes(there) | Next::TimedOut(there) => {
                let target = reward + agent.discount * agent.policy.expected(agent.table.read(there.as_ref()));
                agent.move_towards(here, action, target);
            }
            Next::Terminal => agent.end(here, action, reward),
        }
        agent.go_on(next, draw)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Learner;
    use crate::learners::example::{agent, draw};
    use crate::learners::{Behaviour, Control, Schedule, Ties};

    #[test]
    fn one_update_by_hand() {
        let mut learner = Control { agent: agent(&[1.0, 0.0, 2.0, 4.0]), rule: ExpectedSarsa };
        learner.agent.policy = Behaviour::EpsilonGreedy { epsilon: Schedule::constant(0.5), ties: Ties::First };
        // 1 + 0.5 (-1 + 0.5 (2/4 + 3 · 4/4) - 1)
        learner.learn([0], 0, -1.0, Next::TimedOut([1]), &mut draw());
        assert_eq!(learner.agent.table.values(), [0.875, 0.0, 2.0, 4.0]);
    }
}
