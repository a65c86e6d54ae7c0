//! What every learner is made of: Q, how actions are chosen, how far an update goes.

use super::{Behaviour, Policy, Rate, StepSize};
use crate::random::Draw;
use crate::table::Table;
use crate::world::Next;

/// What an update does at a terminal state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerminalUpdate {
    /// Q ← R, the article's rule: right where the last reward is always the same.
    Assign,
    /// Q ← Q + α (R - Q), the book's: the value of a terminal state is zero.
    Target,
}

/// A table, a policy and the constants of an update.
#[derive(Clone, Debug, PartialEq)]
pub struct Agent<const N: usize = 0, P = Behaviour, A = Rate> {
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

impl<const N: usize, P: Policy, A: StepSize> Agent<N, P, A> {
    /// An action in these rows.
    #[expect(clippy::inline_always, reason = "a call a step costs a tenth of it")]
    #[inline(always)]
    pub fn choose(&mut self, rows: impl AsRef<[u32]>, draw: &mut impl Draw) -> usize {
        self.policy.choose(self.table.read(rows.as_ref()), draw)
    }

    /// S′ and an action A′ there; none after a terminal state. At a time-out A′ is drawn for its value, and not taken.
    #[expect(clippy::inline_always, reason = "a call a step costs a tenth of it")]
    #[inline(always)]
    pub fn follow<R: Copy + AsRef<[u32]>>(&mut self, next: Next<R>, draw: &mut impl Draw) -> Option<(R, usize)> {
        match next {
            Next::Goes(there) | Next::TimedOut(there) => Some((there, self.choose(there, draw))),
            Next::Terminal => None,
        }
    }

    /// An action to go on with, for those whose update needs none; nothing is drawn where the episode ends.
    #[expect(clippy::inline_always, reason = "a call a step costs a tenth of it")]
    #[inline(always)]
    pub fn go_on<R: Copy + AsRef<[u32]>>(&mut self, next: Next<R>, draw: &mut impl Draw) -> usize {
        if let Next::Goes(there) = next { self.choose(there, draw) } else { 0 }
    }

    /// Q(S, A).
    #[inline]
    pub fn value(&self, rows: impl AsRef<[u32]>, action: usize) -> f64 {
        self.table.value(rows.as_ref(), action)
    }

    /// Counts a visit of a pair.
    #[inline]
    pub fn visit(&mut self, rows: impl AsRef<[u32]>, action: usize) {
        for &row in rows.as_ref() {
            self.learning_rate.visit(self.table.weight(row, action));
        }
    }

    /// Q(S, A) ← Q(S, A) + α (target - Q(S, A)).
    #[inline]
    pub fn move_towards(&mut self, rows: impl AsRef<[u32]>, action: usize, target: f64) {
        self.table.move_towards(rows.as_ref(), action, target, &mut self.learning_rate);
    }

    /// The same where nothing follows: the target is the reward, unless the article's rule assigns it.
    #[inline]
    pub fn end(&mut self, rows: impl AsRef<[u32]>, action: usize, reward: f64) {
        self.table.end(rows.as_ref(), action, reward, self.terminal_update, &mut self.learning_rate);
    }

    /// Called after every episode.
    pub fn end_episode(&mut self) {
        self.policy.end_episode();
        self.learning_rate.end_episode();
    }
}
