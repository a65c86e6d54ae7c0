//! State values in addition to a policy: the baseline of REINFORCE, the critic of actor-critic methods.

use crate::features::ActiveFeatures;
use crate::q_table::QTable;
use crate::schedules::LearningRate;

/// v̂(S, w): the sum over the active rows, of which weighted features multiply each by its value. The table has a column for
/// each action, like the policy's preferences, and every column holds the value of the row.
#[derive(Clone, Debug, PartialEq)]
pub struct Critic {
    /// The weights w.
    pub table: QTable,
    /// The step size αʷ, divided by the number of active rows.
    pub step_size: f64,
    /// The step size αʷ of each row; empty if all rows share one.
    pub row_step_sizes: Vec<f64>,
}

impl Critic {
    /// State values with the learning rate αʷ, which is divided as that of the policy.
    pub fn new(table: QTable, learning_rate: f64, of_policy: &LearningRate) -> Self {
        let (step_size, row_step_sizes) = of_policy.divided(learning_rate);
        Self { table, step_size, row_step_sizes }
    }

    /// v̂(S, w).
    #[inline(always)]
    pub fn value<R: ActiveFeatures>(&self, rows: R) -> f64 {
        self.table.value(&rows, 0)
    }

    /// w ← w + αʷ δ ∇v̂(S, w)
    #[inline(always)]
    pub fn update<R: ActiveFeatures>(&mut self, rows: R, error: f64) {
        if R::WEIGHTED {
            for (&row, x) in rows.as_ref().iter().zip(rows.values()) {
                self.add(row, self.step_size_of(row) * error * x);
            }
            return;
        }
        for &row in rows.as_ref() {
            self.add(row, self.step_size * error);
        }
    }

    /// The step size of a row of weighted features.
    #[inline(always)]
    pub(in crate::learners) fn step_size_of(&self, row: u32) -> f64 {
        self.row_step_sizes.get(row as usize).copied().unwrap_or(self.step_size)
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
    use crate::schedules::Schedule;

    #[test]
    fn an_update_adds_to_every_column_of_the_active_rows() {
        let rate = LearningRate::scheduled(Schedule::constant(0.1), 2);
        let mut critic = Critic::new(QTable::zeros(3, 2), 1.0, &rate);
        critic.update([0, 2], 3.0);
        assert_eq!(critic.table.values(), [1.5, 1.5, 0.0, 0.0, 1.5, 1.5]);
        assert_eq!(critic.value([0, 2]), 3.0);
    }

    #[test]
    fn weighted_features_multiply_the_step_size_of_their_row() {
        let rate = LearningRate::scaled_by_row(Schedule::constant(0.1), vec![1.0, 2.0]);
        let mut critic = Critic::new(QTable::zeros(2, 2), 0.5, &rate);
        critic.update(features(), 3.0);
        // 0.5 · 3 · 1, and 0.25 · 3 · 0.5
        assert_eq!(critic.table.values(), [1.5, 1.5, 0.375, 0.375]);
        assert_eq!(critic.value(features()), 1.6875);
        critic.row_step_sizes.clear();
        critic.update(features(), 2.0);
        assert_eq!(critic.table.values(), [2.5, 2.5, 0.875, 0.875]);
    }
}
