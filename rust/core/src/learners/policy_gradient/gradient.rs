//! The gradient of an agent's policy with respect to its table, which then holds preferences.

use crate::features::ActiveFeatures;
use crate::learners::{Agent, masked_values};

impl Agent {
    /// The components of ∇ln π(A | S), one per action. They are the same for each active row, and multiplied by its value for
    /// weighted features.
    #[inline]
    pub(in crate::learners) fn log_gradient(&mut self, rows: impl ActiveFeatures, action: usize) -> &[f64] {
        let values = masked_values::<0>(&mut self.masks, rows.as_ref(), self.table.action_values(&rows));
        self.policy.log_gradient(values, action)
    }

    /// θ ← θ + α scale ∇ln π(A | S, θ)
    #[inline]
    pub(in crate::learners) fn ascend<R: ActiveFeatures>(&mut self, rows: R, action: usize, scale: f64) {
        self.table.check_finite(scale);
        let step = self.learning_rate.shared() * scale;
        let values = masked_values::<0>(&mut self.masks, rows.as_ref(), self.table.action_values(&rows));
        let gradient = self.policy.log_gradient(values, action);
        if R::WEIGHTED {
            for (&row, x) in rows.as_ref().iter().zip(rows.values()) {
                let step = self.learning_rate.of_row(row as usize) * scale;
                for (preference, part) in self.table.row_mut(row).iter_mut().zip(gradient) {
                    *preference += step * part * x;
                }
            }
            return;
        }
        for &row in rows.as_ref() {
            for (preference, part) in self.table.row_mut(row).iter_mut().zip(gradient) {
                *preference += step * part;
            }
        }
    }
}
