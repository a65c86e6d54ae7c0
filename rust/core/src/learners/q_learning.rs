//! Q-learning: off-policy temporal-difference control (Watkins, 1989; Sutton & Barto, equation 6.8).

use super::{Agent, EpsilonGreedy, Policy, StepSize};
use crate::learner::Learner;
use crate::random::Draw;
use crate::table::{Table, maximum};
use crate::world::Next;

/// What an update does at a terminal state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerminalUpdate {
    /// Q ← R, the article's rule: right where the last reward is always the same.
    Assign,
    /// Q ← Q + α (R - Q), the book's: the value of a terminal state is zero.
    Target,
}

/// Q(S, A) ← Q(S, A) + α [R + γ maxₐ Q(S′, a) - Q(S, A)], evaluated from the left.
#[derive(Clone, Debug, PartialEq)]
pub struct QLearning<const N: usize = 0, P = EpsilonGreedy, A = f64> {
    /// Q.
    pub table: Table<N>,
    /// How actions are chosen.
    pub policy: P,
    /// α, over the number of rows lit.
    pub learning_rate: A,
    /// γ.
    pub discount: f64,
    /// What happens at a terminal state.
    pub terminal_update: TerminalUpdate,
}

impl<const N: usize, P, A> From<Agent<N, P, A>> for QLearning<N, P, A> {
    fn from(agent: Agent<N, P, A>) -> Self {
        let Agent { table, policy, learning_rate, discount, terminal_update } = agent;
        Self { table, policy, learning_rate, discount, terminal_update }
    }
}

impl<const N: usize, R, P, A> Learner<R> for QLearning<N, P, A>
where
    R: Copy + AsRef<[u32]>,
    P: Policy,
    A: StepSize,
{
    #[inline]
    fn begin(&mut self, here: R, draw: &mut impl Draw) -> usize {
        self.policy.choose(self.table.read(here.as_ref()), draw)
    }

    #[inline]
    fn learn(&mut self, here: R, action: usize, reward: f64, next: Next<R>, draw: &mut impl Draw) -> usize {
        let here = here.as_ref();
        match next {
            Next::Goes(there) => {
                let target = reward + self.discount * maximum(self.table.read(there.as_ref()));
                self.table.move_towards(here, action, target, &mut self.learning_rate);
                self.policy.choose(self.table.read(there.as_ref()), draw)
            }
            Next::TimedOut(there) => {
                let target = reward + self.discount * maximum(self.table.read(there.as_ref()));
                self.table.move_towards(here, action, target, &mut self.learning_rate);
                0
            }
            Next::Terminal => {
                self.table.end(here, action, reward, self.terminal_update, &mut self.learning_rate);
                0
            }
        }
    }

    fn end_episode(&mut self) {
        self.policy.end_episode();
        self.learning_rate.end_episode();
    }

    fn tables(&self) -> Vec<&[f64]> {
        vec![self.table.values()]
    }

    fn diverged(&self) -> bool {
        self.table.diverged()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn one_update_by_hand() {
        let mut learner = QLearning {
            table: Table::<2>::new(vec![1.0, 0.0, 2.0, 3.0], 2),
            policy: EpsilonGreedy::linear(0.0, 0.0, 1),
            learning_rate: 0.5,
            discount: 0.5,
            terminal_update: TerminalUpdate::Target,
        };
        let mut draw = Pcg64::new(&SeedSequence::new(&[0]));
        // 1 + 0.5 (-1 + 0.5 · 3 - 1)
        assert_eq!(learner.learn([0], 0, -1.0, Next::Goes([1]), &mut draw), 1);
        assert_eq!(learner.table.values(), [0.75, 0.0, 2.0, 3.0]);
        // 3 + 0.5 (-1 - 3)
        learner.learn([1], 1, -1.0, Next::Terminal, &mut draw);
        assert_eq!(learner.table.values(), [0.75, 0.0, 2.0, 1.0]);
    }

    #[test]
    fn rows_lit_together_share_an_update() {
        let mut learner = QLearning {
            table: Table::<2>::new(vec![1.0, 0.0, 2.0, 3.0, 0.0, 4.0], 2),
            policy: EpsilonGreedy::linear(0.0, 0.0, 1),
            learning_rate: 0.25,
            discount: 1.0,
            terminal_update: TerminalUpdate::Target,
        };
        let mut draw = Pcg64::new(&SeedSequence::new(&[0]));
        // Q(S, 0) = 1 + 2, max Q(S', ·) = 3 + 4: each weight moves by 0.25 (-2 + 7 - 3).
        learner.learn([0, 1], 0, -2.0, Next::Goes([1, 2]), &mut draw);
        assert_eq!(learner.table.values(), [1.5, 0.0, 2.5, 3.0, 0.0, 4.0]);
    }
}
