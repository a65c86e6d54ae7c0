//! What Dyna remembers: where each pair led the last time (Sutton & Barto, section 8.2).

use super::Agent;
use crate::numeric::maximum;
use crate::random::Rng;
use crate::tasks::Next;

/// What followed a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelEntry {
    /// The reward.
    pub reward: f64,
    /// The row of the next state; none after a terminal one.
    pub next: Option<u32>,
}

/// A model of a world that always answers a pair in the same way: the last answer counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    actions: usize,
    outcomes: Vec<Option<ModelEntry>>,
    /// Active in the order of their first visits.
    visited: Vec<u32>,
    /// Of each row the actions in the order in which they were first tried, then nothing of meaning.
    tried: Vec<u32>,
    /// How many were tried in each row.
    counts: Vec<u32>,
}

impl Model {
    /// Nothing known of so many rows.
    pub fn new(rows: usize, actions: usize) -> Self {
        Self {
            actions,
            outcomes: vec![None; rows * actions],
            visited: Vec::new(),
            tried: vec![0; rows * actions],
            counts: vec![0; rows],
        }
    }

    /// How many pairs there are.
    pub(crate) fn pairs(&self) -> usize {
        self.outcomes.len()
    }

    /// Remembers what followed.
    pub fn remember(&mut self, row: u32, action: usize, outcome: ModelEntry) {
        let (pairs, index) = (row as usize * self.actions, row as usize * self.actions + action);
        if self.outcomes[index].is_none() {
            let count = &mut self.counts[row as usize];
            if *count == 0 {
                self.visited.push(row);
            }
            self.tried[pairs + *count as usize] = action as u32;
            *count += 1;
        }
        self.outcomes[index] = Some(outcome);
    }

    /// What followed a pair the last time, if it was ever tried.
    pub fn outcome(&self, row: u32, action: usize) -> Option<ModelEntry> {
        self.outcomes[row as usize * self.actions + action]
    }

    /// A row visited before.
    ///
    /// # Panics
    /// If none was.
    pub fn sample_state(&self, rng: &mut impl Rng) -> u32 {
        self.visited[rng.integers(self.visited.len() as u32) as usize]
    }

    /// An action tried before in a row that was visited.
    pub fn sample_action(&self, row: u32, rng: &mut impl Rng) -> usize {
        let tried = rng.integers(self.counts[row as usize]);
        self.tried[row as usize * self.actions + tried as usize] as usize
    }
}

impl Agent {
    /// Q(S, A) ← Q(S, A) + α [R + γ maxₐ Q(S′, a) - Q(S, A)] of a lone row.
    pub(crate) fn update_from_entry(&mut self, row: u32, action: usize, outcome: ModelEntry) {
        match outcome.next {
            Some(next) => {
                let target = outcome.reward + self.discount * maximum(self.table.row(next));
                self.update([row], action, target);
            }
            None => self.update_terminal([row], action, outcome.reward),
        }
    }
}

impl ModelEntry {
    /// What a step has brought; a time-out leads on.
    ///
    /// # Panics
    /// If a state is not one row.
    pub(crate) fn new<R: AsRef<[u32]>>(reward: f64, next: &Next<R>) -> Self {
        let next = match next {
            Next::NonTerminal(next_state) | Next::Truncated(next_state) => Some(single_row(next_state)),
            Next::Terminal => None,
        };
        Self { reward, next }
    }
}

/// The row of a state that is one row.
pub(crate) fn single_row(rows: &impl AsRef<[u32]>) -> u32 {
    let &[row] = rows.as_ref() else { unreachable!("a model of pairs needs a table, not tile coding") };
    row
}
