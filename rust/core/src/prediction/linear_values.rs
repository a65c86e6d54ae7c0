//! Estimated state values: the weights, their features and their step sizes.

use super::{RowSets, StateRows};
use crate::schedules::{LearningRate, StepSize};

/// v(s) = Σ w over the active rows of s, from left to right. With one row for each state it is a table.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearValues<S = StateRows> {
    /// The weights w.
    pub weights: Vec<f64>,
    /// The active rows of each state.
    pub rows: S,
    /// The learning rate α, divided by the number of active rows.
    pub learning_rate: LearningRate,
    /// The discount γ.
    pub discount: f64,
    diverged: bool,
}

impl<S: RowSets> LinearValues<S> {
    /// The values before the first episode.
    ///
    /// # Panics
    /// If there is not a weight for each row.
    pub fn new(weights: Vec<f64>, rows: S, learning_rate: LearningRate, discount: f64) -> Self {
        assert_eq!(weights.len(), rows.n_weights(), "there must be a weight for each row");
        Self { weights, rows, learning_rate, discount, diverged: false }
    }

    /// v(S).
    #[inline]
    pub fn value(&self, state: u32) -> f64 {
        if self.rows.n_active() == 1 {
            return self.weights[self.rows.first(state)];
        }
        let mut values = self.rows.of(state).iter().map(|&row| self.weights[row as usize]);
        let first = values.next().unwrap_or(0.0);
        values.fold(first, |sum, value| sum + value)
    }

    /// w ← w + α [target - v(S)] ∇v(S).
    #[inline]
    pub fn update(&mut self, state: u32, target: f64) {
        let error = target - self.value(state);
        self.check_finite(error);
        if self.rows.n_active() == 1 {
            let row = self.rows.first(state);
            self.learning_rate.visit(row);
            self.weights[row] += self.learning_rate.at(row) * error;
            return;
        }
        for &row in self.rows.of(state) {
            self.learning_rate.visit(row as usize);
            self.weights[row as usize] += self.learning_rate.at(row as usize) * error;
        }
    }

    /// The step size that all weights share. The methods with traces need one.
    #[inline]
    pub fn step_size(&self) -> f64 {
        self.learning_rate.at(0)
    }

    /// Notes an error that is no finite number.
    #[inline]
    pub fn check_finite(&mut self, error: f64) {
        self.diverged |= !error.is_finite();
    }

    /// Notes that the values will never settle.
    pub fn give_up(&mut self) {
        self.diverged = true;
    }

    /// Whether a value has overflowed, or the values will never settle.
    pub fn diverged(&self) -> bool {
        self.diverged
    }
}
