//! State values in addition to a policy: the baseline of REINFORCE, the critic of actor-critic methods.

use crate::features::{ActiveFeatures, assert_binary};
use crate::q_table::QTable;

/// v̂(S, w): the sum over the active rows. The table has a column for each action, like the policy's preferences, and
/// every column holds the value of the row. Its methods panic for weighted features.
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
    pub fn value<R: ActiveFeatures>(&self, rows: R) -> f64 {
        assert_binary::<R>();
        self.table.value(&rows, 0)
    }

    /// w ← w + αʷ δ ∇v̂(S, w)
    #[inline]
    pub fn update<R: ActiveFeatures>(&mut self, rows: R, error: f64) {
        assert_binary::<R>();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::features;

    #[test]
    fn an_update_adds_to_every_column_of_the_active_rows() {
        let mut critic = Critic { table: QTable::zeros(3, 2), step_size: 0.5 };
        critic.update([0, 2], 3.0);
        assert_eq!(critic.table.values(), [1.5, 1.5, 0.0, 0.0, 1.5, 1.5]);
        assert_eq!(critic.value([0, 2]), 3.0);
    }

    #[test]
    #[should_panic(expected = "needs binary features")]
    fn the_value_of_weighted_features_is_refused() {
        Critic { table: QTable::zeros(2, 2), step_size: 0.5 }.value(features());
    }

    #[test]
    #[should_panic(expected = "needs binary features")]
    fn an_update_of_weighted_features_is_refused() {
        Critic { table: QTable::zeros(2, 2), step_size: 0.5 }.update(features(), 1.0);
    }
}
