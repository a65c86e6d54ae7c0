//! The features of states that are numbered: a table, state aggregation, tile coding.

use std::sync::Arc;

use super::RowSets;

/// The active rows of each state, as many for every state. Clones share them.
#[derive(Clone, Debug, PartialEq)]
pub struct StateRows {
    rows: Arc<[u32]>,
    n_active: usize,
    n_weights: usize,
}

impl StateRows {
    /// `rows` holds `n_active` rows for each state, those of state 0 first, each less than `n_weights`; `None` if it does
    /// not.
    pub fn new(rows: Arc<[u32]>, n_active: usize, n_weights: usize) -> Option<Self> {
        let fits =
            n_active > 0 && rows.len().is_multiple_of(n_active) && rows.iter().all(|&row| (row as usize) < n_weights);
        fits.then_some(Self { rows, n_active, n_weights })
    }

    /// The number of states.
    pub fn num_states(&self) -> usize {
        self.rows.len() / self.n_active
    }
}

/// The active row of a task is the number of its state.
impl RowSets for StateRows {
    #[inline]
    fn of(&self, state: u32) -> &[u32] {
        &self.rows[state as usize * self.n_active..][..self.n_active]
    }

    #[inline]
    fn first(&self, state: u32) -> usize {
        self.rows[state as usize * self.n_active] as usize
    }

    #[inline]
    fn n_active(&self) -> usize {
        self.n_active
    }

    fn n_weights(&self) -> usize {
        self.n_weights
    }

    #[inline]
    fn begin(&mut self, active: &[u32]) -> u32 {
        active[0]
    }

    #[inline]
    fn current(&self, active: &[u32]) -> u32 {
        active[0]
    }

    #[inline]
    fn visit_next(&mut self, active: &[u32]) -> u32 {
        active[0]
    }
}
