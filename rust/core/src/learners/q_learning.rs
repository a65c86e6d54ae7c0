//! Q-learning: off-policy temporal-difference control (Watkins, 1989; Sutton & Barto, equation 6.8).

use super::EpsilonGreedy;
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
pub struct QLearning<const N: usize = 0> {
    /// Q.
    pub table: Table<N>,
    /// How actions are chosen.
    pub policy: EpsilonGreedy,
    /// α.
    pub learning_rate: f64,
    /// γ.
    pub discount: f64,
    /// What happens at a terminal state.
    pub terminal_update: TerminalUpdate,
}

impl<const N: usize> QLearning<N> {
    #[inline]
    fn move_towards(&mut self, row: u32, action: usize, target: f64) {
        let value = self.table.value_mut(row, action);
        *value += self.learning_rate * (target - *value);
    }
}

impl<const N: usize> Learner<[u32; 1]> for QLearning<N> {
    #[inline]
    fn begin(&mut self, [here]: [u32; 1], draw: &mut impl Draw) -> usize {
        self.policy.choose(self.table.row(here), draw)
    }

    #[inline]
    fn learn(
        &mut self,
        [here]: [u32; 1],
        action: usize,
        reward: f64,
        next: Next<[u32; 1]>,
        draw: &mut impl Draw,
    ) -> usize {
        match next {
            Next::Goes([there]) => {
                let target = reward + self.discount * maximum(self.table.row(there));
                self.move_towards(here, action, target);
                self.policy.choose(self.table.row(there), draw)
            }
            Next::TimedOut([there]) => {
                let target = reward + self.discount * maximum(self.table.row(there));
                self.move_towards(here, action, target);
                0
            }
            Next::Terminal => {
                match self.terminal_update {
                    TerminalUpdate::Assign => *self.table.value_mut(here, action) = reward,
                    TerminalUpdate::Target => self.move_towards(here, action, reward),
                }
                0
            }
        }
    }

    fn end_episode(&mut self) {
        self.policy.end_episode();
    }

    fn tables(&self) -> &[f64] {
        self.table.values()
    }
}
