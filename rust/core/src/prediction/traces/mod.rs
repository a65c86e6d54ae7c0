//! Eligibility traces of state values, and the methods with traces (Sutton & Barto, chapter 12).

mod td_lambda;
mod true_online_td_lambda;

pub use td_lambda::TdLambda;
pub use true_online_td_lambda::TrueOnlineTdLambda;

use super::StateFeatures;
use super::linear_values::add_scaled;
use crate::schedules::{LearningRate, StepSize};

/// The traces z of all weights, and the indices of those that may be nonzero: with weighted features all.
#[derive(Clone, Debug, PartialEq)]
struct StateTraces {
    values: Vec<f64>,
    eligible: Vec<u32>,
    is_eligible: Vec<bool>,
}

impl StateTraces {
    fn new(weights: usize) -> Self {
        Self { values: vec![0.0; weights], eligible: Vec::with_capacity(weights), is_eligible: vec![false; weights] }
    }

    /// z ← z + scale x(S).
    #[inline]
    fn add(&mut self, features: &StateFeatures, state: u32, scale: f64) {
        if let Some(x) = features.vector(state) {
            return self.add_vector(x, scale);
        }
        for &row in features.of(state) {
            self.mark(row);
            self.values[row as usize] += scale;
        }
    }

    fn add_vector(&mut self, x: &[f64], scale: f64) {
        if !self.are_all_eligible() {
            (0..self.values.len() as u32).for_each(|row| self.mark(row));
        }
        self.values.iter_mut().zip(x).for_each(|(trace, x)| *trace += scale * x);
    }

    #[inline]
    fn mark(&mut self, row: u32) {
        if !std::mem::replace(&mut self.is_eligible[row as usize], true) {
            self.eligible.push(row);
        }
    }

    #[inline]
    fn are_all_eligible(&self) -> bool {
        self.eligible.len() == self.values.len()
    }

    /// Multiplies all traces by a factor.
    #[inline]
    fn multiply(&mut self, factor: f64) {
        if self.are_all_eligible() {
            self.values.iter_mut().for_each(|trace| *trace *= factor);
            return;
        }
        for &row in &self.eligible {
            self.values[row as usize] *= factor;
        }
    }

    /// wᵢ ← wᵢ + (αᵢ error) zᵢ.
    #[inline]
    fn apply(&self, weights: &mut [f64], rate: &LearningRate, error: f64) {
        if self.are_all_eligible() {
            return add_scaled(weights, rate, error, &self.values);
        }
        // Only weighted features, whose traces are all eligible, have a step size for each weight.
        let change = rate.at(0) * error;
        for &row in &self.eligible {
            weights[row as usize] += change * self.values[row as usize];
        }
    }

    /// z ← 0.
    fn clear(&mut self) {
        for row in self.eligible.drain(..) {
            self.values[row as usize] = 0.0;
            self.is_eligible[row as usize] = false;
        }
    }

    /// The work of one pass over the traces.
    #[inline]
    fn work(&self) -> u64 {
        1 + self.eligible.len() as u64 / 4
    }
}
