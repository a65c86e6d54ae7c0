//! What Dyna remembers: where each pair led the last time (Sutton & Barto, section 8.2).

use crate::random::Draw;

/// What followed a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The reward.
    pub reward: f64,
    /// The row of the next state; none after a terminal one.
    pub next: Option<u32>,
}

/// A model of a world that always answers a pair in the same way: the last answer counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    actions: usize,
    outcomes: Vec<Option<Outcome>>,
    /// Rows in the order of their first visits.
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
    pub fn remember(&mut self, row: u32, action: usize, outcome: Outcome) {
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
    pub fn outcome(&self, row: u32, action: usize) -> Option<Outcome> {
        self.outcomes[row as usize * self.actions + action]
    }

    /// A row visited before.
    ///
    /// # Panics
    /// If none was.
    pub fn any_row(&self, draw: &mut impl Draw) -> u32 {
        self.visited[draw.integers(self.visited.len() as u32) as usize]
    }

    /// An action tried before in a row that was visited.
    pub fn any_action(&self, row: u32, draw: &mut impl Draw) -> usize {
        let tried = draw.integers(self.counts[row as usize]);
        self.tried[row as usize * self.actions + tried as usize] as usize
    }
}
