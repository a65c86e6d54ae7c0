//! The model that Dyna plans with (Sutton & Barto, section 8.2).

use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::ActiveFeatures;
use crate::learners::Agent;
use crate::memory::{AllocationError, filled, with_capacity};
use crate::numeric::maximum;
use crate::random::Rng;
use crate::tasks::Next;

/// The reward and the next state that followed a state-action pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelEntry {
    /// The reward.
    pub reward: f64,
    /// The row of the next state; `None` if it was terminal.
    pub next: Option<u32>,
}

impl ModelEntry {
    /// The entry of a step. A truncated episode counts as non-terminal.
    ///
    /// # Panics
    /// If the next state has more than one active row.
    pub(crate) fn new<R: ActiveFeatures>(reward: f64, next: &Next<R>) -> Self {
        let next = match next {
            Next::NonTerminal(next_state) | Next::Truncated(next_state) => Some(single_row(next_state)),
            Next::Terminal => None,
        };
        Self { reward, next }
    }
}

/// A deterministic model of the environment: for each state-action pair the last reward and next state.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    num_actions: usize,
    /// The entry of each pair; `None` if the pair was never tried.
    entries: Vec<Option<ModelEntry>>,
    /// The visited rows, in the order of their first visits.
    visited: Vec<u32>,
    /// For each row the actions tried, in the order in which they were first tried. Only the first `counts[row]` of the
    /// `num_actions` numbers are meaningful.
    tried: Vec<u32>,
    /// The number of actions tried in each row.
    counts: Vec<u32>,
}

impl Model {
    /// An empty model, with room for all pairs.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(rows: usize, num_actions: usize, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        Ok(Self {
            num_actions,
            entries: filled(&None, rows * num_actions, stop)?,
            visited: with_capacity(rows)?,
            tried: filled(&0, rows * num_actions, stop)?,
            counts: filled(&0, rows, stop)?,
        })
    }

    /// The number of actions.
    pub(crate) fn num_actions(&self) -> usize {
        self.num_actions
    }

    /// The number of state-action pairs.
    pub(crate) fn num_pairs(&self) -> usize {
        self.entries.len()
    }

    /// The index of a pair.
    #[inline]
    pub(crate) fn pair(&self, row: u32, action: usize) -> usize {
        row as usize * self.num_actions + action
    }

    /// Replaces the entry of a pair.
    pub fn record(&mut self, row: u32, action: usize, entry: ModelEntry) {
        let row_start = row as usize * self.num_actions;
        let index = row_start + action;
        if self.entries[index].is_none() {
            let count = &mut self.counts[row as usize];
            if *count == 0 {
                self.visited.push(row);
            }
            self.tried[row_start + *count as usize] = action as u32;
            *count += 1;
        }
        self.entries[index] = Some(entry);
    }

    /// The entry of a pair, if it was ever tried.
    pub fn entry(&self, row: u32, action: usize) -> Option<ModelEntry> {
        self.entries[self.pair(row, action)]
    }

    /// Whether the model has not learned from any transition yet.
    pub fn is_empty(&self) -> bool {
        self.visited.is_empty()
    }

    /// A random row among those visited.
    ///
    /// # Panics
    /// If no row was visited.
    #[inline]
    pub fn sample_state(&self, rng: &mut impl Rng) -> u32 {
        self.visited[rng.integers(self.visited.len() as u32) as usize]
    }

    /// A random action among those tried in a visited row.
    #[inline]
    pub fn sample_action(&self, row: u32, rng: &mut impl Rng) -> usize {
        let index = rng.integers(self.counts[row as usize]);
        self.tried[row as usize * self.num_actions + index as usize] as usize
    }
}

/// Saves the entries row by row in the order in which their pairs were first tried, because planning draws indices into
/// that order.
impl Persist for Model {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let (rows, num_actions) = (self.counts.len(), self.num_actions);
        let mut visited = self.visited.len();
        checkpoint.index(&mut visited, rows + 1, "number of visited rows")?;
        if checkpoint.is_restoring() {
            self.entries.fill(None);
            self.visited.clear();
            self.counts.fill(0);
        }
        for index in 0..visited {
            let mut row = self.visited.get(index).copied().unwrap_or_default();
            checkpoint.index_u32(&mut row, rows, "visited row")?;
            let mut tried = self.counts[row as usize] as usize;
            checkpoint.index(&mut tried, num_actions + 1, "number of actions tried")?;
            for position in 0..tried {
                self.persist_entry(row, position, checkpoint)?;
            }
            checkpoint.check(self.visited.get(index) == Some(&row), "visited row")?;
        }
        Ok(())
    }
}

impl Model {
    /// Saves or restores the entry of the action at `position` in the order in which the actions of a row were tried.
    fn persist_entry(
        &mut self,
        row: u32,
        position: usize,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), CheckpointError> {
        let mut action = self.tried[row as usize * self.num_actions + position];
        checkpoint.index_u32(&mut action, self.num_actions, "action tried")?;
        let known = self.entry(row, action as usize);
        let ModelEntry { mut reward, mut next } = known.unwrap_or(ModelEntry { reward: 0.0, next: None });
        (&mut reward, &mut next).persist(checkpoint)?;
        checkpoint.check(next.is_none_or(|next| (next as usize) < self.counts.len()), "row of the model")?;
        if checkpoint.is_restoring() {
            checkpoint.check(known.is_none(), "action tried twice")?;
            self.record(row, action as usize, ModelEntry { reward, next });
        }
        Ok(())
    }
}

impl Agent {
    /// Q-learning's update from a transition: Q(S, A) ← Q(S, A) + α [R + γ maxₐ Q(S′, a) - Q(S, A)]. `next` is the row
    /// of S′; `None` if it is terminal.
    ///
    /// The parameters are the fields of a [`ModelEntry`], which would itself be passed through memory.
    pub(crate) fn update_from_transition(&mut self, row: u32, action: usize, reward: f64, next: Option<u32>) {
        match next {
            Some(next) => {
                let target = reward + self.discount * maximum(self.action_values([next]));
                self.update([row], action, target);
            }
            None => self.update_terminal([row], action, reward),
        }
    }
}

/// The row of a state with one active row.
pub(crate) fn single_row(rows: &impl ActiveFeatures) -> u32 {
    let &[row] = rows.as_ref() else { unreachable!("a learner of tables has one active row per state") };
    row
}
