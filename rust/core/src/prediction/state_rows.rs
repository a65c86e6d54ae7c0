//! The features of states that are numbered: a table, state aggregation, tile coding.

use std::sync::Arc;

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
        let fits = n_active > 0 && rows.len() % n_active == 0 && rows.iter().all(|&row| (row as usize) < n_weights);
        fits.then_some(Self { rows, n_active, n_weights })
    }

    /// The active rows of a state.
    #[inline]
    pub fn of(&self, state: u32) -> &[u32] {
        &self.rows[state as usize * self.n_active..][..self.n_active]
    }

    /// The row of a state that has one active row; the first one otherwise.
    #[inline]
    pub fn first(&self, state: u32) -> usize {
        self.rows[state as usize * self.n_active] as usize
    }

    /// The number of states.
    pub fn num_states(&self) -> usize {
        self.rows.len() / self.n_active
    }

    /// The number of active rows of a state.
    #[inline]
    pub fn n_active(&self) -> usize {
        self.n_active
    }

    /// The number of weights.
    pub fn n_weights(&self) -> usize {
        self.n_weights
    }
}
