//! State values in addition to a policy: the baseline of REINFORCE, the critic of actor-critic methods.

use crate::features::ActiveFeatures;
use crate::q_table::QTable;

/// v̂(S, w): the sum over the active rows. The table has a column for each action, like the policy's preferences, and
/// every column holds the value of the row.
#[derive(Clone, Debug, PartialEq)]
pub struct Critic {
    /// The weights w.
    pub table: QTable,
    /// The step size αʷ, divided by the number of active rows.
    pub step_size: f64,
}

impl Critic {
    /// v̂(S, w).
    #[inline]
    pub fn value(&self, rows: impl ActiveFeatures) -> f64 {
        self.table.value(&rows, 0)
    }

    /// w ← w + αʷ δ ∇v̂(S, w)
    #[inline]
    pub fn update(&mut self, rows: impl ActiveFeatures, error: f64) {
        for &row in rows.as_ref() {
            self.add(row, self.step_size * error);
        }
    }

    /// Adds to the weight of a row.
    #[inline]
    pub(in crate::learners) fn add(&mut self, row: u32, change: f64) {
        for action in 0..self.table.num_actions() {
            *self.table.value_mut(row, action) += change;
        }
    }
}
