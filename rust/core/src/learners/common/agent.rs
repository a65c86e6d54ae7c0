//! What every learner is made of: Q, how actions are chosen, how far an update goes.

use crate::policies::{AnyPolicy, Policy};
use crate::q_table::QTable;
use crate::q_table::TerminalUpdate;
use crate::random::Rng;
use crate::schedules::{LearningRate, StepSize};
use crate::tasks::Next;

/// A table, a policy and the constants of an update.
#[derive(Clone, Debug, PartialEq)]
pub struct Agent<const N: usize = 0, P = AnyPolicy, A = LearningRate> {
    /// Q.
    pub table: QTable<N>,
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
    pub fn choose(&mut self, rows: impl AsRef<[u32]>, rng: &mut impl Rng) -> usize {
        self.policy.choose(self.table.action_values(rows.as_ref()), rng)
    }

    /// S′ and an action A′ there; none after a terminal state. At a time-out A′ is drawn for its value, and not taken.
    #[expect(clippy::inline_always, reason = "a call a step costs a tenth of it")]
    #[inline(always)]
    pub fn sample_next<R: Copy + AsRef<[u32]>>(&mut self, next: Next<R>, rng: &mut impl Rng) -> Option<(R, usize)> {
        match next {
            Next::NonTerminal(next_state) | Next::Truncated(next_state) => {
                Some((next_state, self.choose(next_state, rng)))
            }
            Next::Terminal => None,
        }
    }

    /// An action to go on with, for those whose update needs none; nothing is drawn where the episode ends.
    #[expect(clippy::inline_always, reason = "a call a step costs a tenth of it")]
    #[inline(always)]
    pub fn next_action<R: Copy + AsRef<[u32]>>(&mut self, next: Next<R>, rng: &mut impl Rng) -> usize {
        if let Next::NonTerminal(next_state) = next { self.choose(next_state, rng) } else { 0 }
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
            self.learning_rate.visit(self.table.weight_index(row, action));
        }
    }

    /// Q(S, A) ← Q(S, A) + α (target - Q(S, A)).
    #[inline]
    pub fn update(&mut self, rows: impl AsRef<[u32]>, action: usize, target: f64) {
        self.table.update(rows.as_ref(), action, target, &mut self.learning_rate);
    }

    /// The same where nothing follows: the target is the reward, unless the article's rule assigns it.
    #[inline]
    pub fn update_terminal(&mut self, rows: impl AsRef<[u32]>, action: usize, reward: f64) {
        self.table.update_terminal(rows.as_ref(), action, reward, self.terminal_update, &mut self.learning_rate);
    }

    /// Called after every episode.
    pub fn end_episode(&mut self) {
        self.policy.end_episode();
        self.learning_rate.end_episode();
    }
}
