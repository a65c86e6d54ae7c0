//! Expected Sarsa (van Seijen et al., 2009; Sutton & Barto, equation 6.9).

use super::{Agent, Policy, StepSize};
use crate::learner::Learner;
use crate::random::Draw;
use crate::world::Next;

/// Q(S, A) ← Q(S, A) + α [R + γ Σₐ π(a | S′) Q(S′, a) - Q(S, A)]. The next action is chosen after the update.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedSarsa<G = Agent> {
    /// Q, the policy and the constants.
    pub agent: G,
}

impl<const N: usize, R, P, A> Learner<R> for ExpectedSarsa<Agent<N, P, A>>
where
    R: Copy + AsRef<[u32]>,
    P: Policy,
    A: StepSize,
{
    #[inline]
    fn begin(&mut self, here: R, draw: &mut impl Draw) -> usize {
        self.agent.choose(here, draw)
    }

    #[inline]
    fn learn(&mut self, here: R, action: usize, reward: f64, next: Next<R>, draw: &mut impl Draw) -> usize {
        let agent = &mut self.agent;
        match next {
            Next::Goes(there) | Next::TimedOut(there) => {
                let target = reward + agent.discount * agent.policy.expected(agent.table.read(there.as_ref()));
                agent.move_towards(here, action, target);
                if let Next::Goes(there) = next { agent.choose(there, draw) } else { 0 }
            }
            Next::Terminal => {
                agent.end(here, action, reward);
                0
            }
        }
    }

    fn end_episode(&mut self) {
        self.agent.end_episode();
    }

    fn tables(&self) -> Vec<&[f64]> {
        vec![self.agent.table.values()]
    }

    fn diverged(&self) -> bool {
        self.agent.table.diverged()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::example::{agent, draw};
    use crate::learners::{Behaviour, Schedule, Ties};

    #[test]
    fn one_update_by_hand() {
        let mut learner = ExpectedSarsa { agent: agent(&[1.0, 0.0, 2.0, 4.0]) };
        learner.agent.policy = Behaviour::EpsilonGreedy { epsilon: Schedule::constant(0.5), ties: Ties::First };
        // 1 + 0.5 (-1 + 0.5 (2/4 + 3 · 4/4) - 1)
        learner.learn([0], 0, -1.0, Next::TimedOut([1]), &mut draw());
        assert_eq!(learner.agent.table.values(), [0.875, 0.0, 2.0, 4.0]);
    }
}
