//! Sarsa: on-policy temporal-difference control (Rummery & Niranjan, 1994; Sutton & Barto, equation 6.7).

use super::{Agent, Policy, StepSize};
use crate::learner::Learner;
use crate::random::Draw;
use crate::world::Next;

/// Q(S, A) ← Q(S, A) + α [R + γ Q(S′, A′) - Q(S, A)], A′ chosen before the update.
#[derive(Clone, Debug, PartialEq)]
pub struct Sarsa<G = Agent> {
    /// Q, the policy and the constants.
    pub agent: G,
}

impl<const N: usize, R, P, A> Learner<R> for Sarsa<Agent<N, P, A>>
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
        match next {
            // At a time-out A′ is drawn for its value and not taken.
            Next::Goes(there) | Next::TimedOut(there) => {
                let next_action = self.agent.choose(there, draw);
                let target = reward + self.agent.discount * self.agent.value(there, next_action);
                self.agent.move_towards(here, action, target);
                next_action
            }
            Next::Terminal => {
                self.agent.end(here, action, reward);
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

    #[test]
    fn one_update_by_hand() {
        let mut learner = Sarsa { agent: agent(&[1.0, 0.0, 2.0, 3.0]) };
        // 1 + 0.5 (-1 + 0.5 · 3 - 1)
        assert_eq!(learner.learn([0], 0, -1.0, Next::Goes([1]), &mut draw()), 1);
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 2.0, 3.0]);
    }

    #[test]
    fn a_time_out_bootstraps_and_a_terminal_state_does_not() {
        let mut learner = Sarsa { agent: agent(&[1.0, 0.0, 2.0, 3.0]) };
        learner.learn([0], 0, -1.0, Next::TimedOut([1]), &mut draw());
        learner.learn([1], 0, -1.0, Next::Terminal, &mut draw());
        // 2 + 0.5 (-1 - 2)
        assert_eq!(learner.agent.table.values(), [0.75, 0.0, 0.5, 3.0]);
    }
}
