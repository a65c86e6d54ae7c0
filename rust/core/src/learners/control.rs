//! What the learners of one agent share, so that the file of each holds its equation and nothing else.

use super::{Agent, Policy, StepSize};
use crate::learner::Learner;
use crate::random::Draw;
use crate::world::Next;

/// How a step changes an agent `G`: an equation, and what it remembers from step to step.
pub trait Rule<R, G> {
    /// Learns from one step and returns the next action, as [`Learner::learn`].
    fn learn(
        &mut self,
        agent: &mut G,
        here: R,
        action: usize,
        reward: f64,
        next: Next<R>,
        draw: &mut impl Draw,
    ) -> usize;

    /// Called after the last step of every episode.
    fn end_episode(&mut self) {}
}

/// An agent that learns by a rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Control<U, G = Agent> {
    /// Q, the policy and the constants.
    pub agent: G,
    /// How a step changes them.
    pub rule: U,
}

impl<const N: usize, R, U, P, A> Learner<R> for Control<U, Agent<N, P, A>>
where
    R: Copy + AsRef<[u32]>,
    U: Rule<R, Agent<N, P, A>>,
    P: Policy,
    A: StepSize,
{
    #[inline]
    fn begin(&mut self, here: R, draw: &mut impl Draw) -> usize {
        self.agent.choose(here, draw)
    }

    #[inline]
    fn learn(&mut self, here: R, action: usize, reward: f64, next: Next<R>, draw: &mut impl Draw) -> usize {
        self.rule.learn(&mut self.agent, here, action, reward, next, draw)
    }

    fn end_episode(&mut self) {
        self.rule.end_episode();
        self.agent.end_episode();
    }

    fn tables(&self) -> Vec<&[f64]> {
        vec![self.agent.table.values()]
    }

    fn diverged(&self) -> bool {
        self.agent.table.diverged()
    }
}
