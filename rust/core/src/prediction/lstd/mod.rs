//! Least-squares TD (S. Bradtke and A. Barto, 1996; J. Boyan, 1999; Sutton & Barto, section 9.8).

mod matrix;

use matrix::{product, solve};

use super::{LinearValues, PredictionRule, PredictionStep, StateFeatures};
use crate::StopFlag;
use crate::memory::{AllocationError, filled};
use crate::tasks::Next;

/// The number of products of a matrix in the time of one unit of work.
const PRODUCTS_PER_WORK: u64 = 8;

/// With the traces z, which start at 0 in each episode, A = εI + Σ z (x - γ x′)ᵀ and b = Σ R z over all steps so far, the
/// weights after each episode are w = A⁻¹ b:
///
/// - z ← γλ z + x
/// - if recursive: v ← A⁻¹ᵀ (x - γ x′), then A⁻¹ ← A⁻¹ - (A⁻¹ z) vᵀ / (1 + vᵀz), the Sherman-Morrison formula (equation 9.22)
/// - otherwise: A ← A + z (x - γ x′)ᵀ, and after the episode A w = b is solved
/// - b ← b + R z
///
/// Sums run from left to right. Binary features are vectors of the numbers of times that each feature occurs.
#[derive(Clone, Debug, PartialEq)]
pub struct Lstd {
    trace_decay: f64,
    recursive: bool,
    /// A⁻¹ if recursive, otherwise A, row by row.
    matrix: Vec<f64>,
    b: Vec<f64>,
    z: Vec<f64>,
    /// x - γ x′.
    difference: Vec<f64>,
    v: Vec<f64>,
    /// A⁻¹ z; while equations are solved, b.
    along: Vec<f64>,
    /// A while equations are solved; empty if recursive.
    scratch: Vec<f64>,
}

impl Lstd {
    /// `trace_decay` is λ, `epsilon` is ε, above 0 and with a finite reciprocal if `recursive`, and `weights` the number of
    /// weights.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(
        trace_decay: f64,
        epsilon: f64,
        recursive: bool,
        weights: usize,
        stop: &StopFlag<'_>,
    ) -> Result<Self, AllocationError> {
        let mut matrix = filled(&0.0, weights.saturating_mul(weights), stop)?;
        let scale = if recursive { 1.0 / epsilon } else { epsilon };
        matrix.iter_mut().step_by(weights + 1).for_each(|number| *number = scale);
        let scratch = filled(&0.0, if recursive { 0 } else { matrix.len() }, stop)?;
        let vector = || vec![0.0; weights];
        let (b, z, difference, v, along) = (vector(), vector(), vector(), vector(), vector());
        Ok(Self { trace_decay, recursive, matrix, b, z, difference, v, along, scratch })
    }

    /// Adds the vectors of a state and the next one to the traces and the difference.
    fn read(&mut self, features: &StateFeatures, discount: f64, step: PredictionStep) {
        let decay = discount * self.trace_decay;
        self.difference.fill(0.0);
        add_features(&mut self.difference, features, step.state);
        for (trace, x) in self.z.iter_mut().zip(&self.difference) {
            *trace = *trace * decay + x;
        }
        if let Next::NonTerminal(next) | Next::Truncated(next) = step.next {
            self.along.fill(0.0);
            add_features(&mut self.along, features, next);
            for (difference, next_x) in self.difference.iter_mut().zip(&self.along) {
                *difference -= discount * next_x;
            }
        }
    }

    /// Updates A⁻¹. Returns `false` if A would be singular.
    fn update_inverse(&mut self) -> bool {
        let Self { matrix, z, difference, v, along, .. } = self;
        let weights = z.len();
        // A⁻¹ᵀ (x - γ x′), as a sum of the rows of A⁻¹.
        for (index, (row, factor)) in matrix.chunks_exact(weights).zip(&*difference).enumerate() {
            for (sum, number) in v.iter_mut().zip(row) {
                *sum = if index == 0 { number * factor } else { *sum + number * factor };
            }
        }
        product(along, matrix, z);
        let scalar = v.iter().zip(&*z).skip(1).fold(v[0] * z[0], |sum, (v, z)| sum + v * z);
        let denominator = 1.0 + scalar;
        for (row, along) in matrix.chunks_exact_mut(weights).zip(&*along) {
            for (number, v) in row.iter_mut().zip(&*v) {
                *number -= along * v / denominator;
            }
        }
        denominator != 0.0 && denominator.is_finite()
    }

    /// Updates A.
    fn update_sum(&mut self) {
        for (row, trace) in self.matrix.chunks_exact_mut(self.z.len()).zip(&self.z) {
            for (number, difference) in row.iter_mut().zip(&self.difference) {
                *number += trace * difference;
            }
        }
    }
}

impl PredictionRule for Lstd {
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep) {
        self.read(&values.features, values.discount, step);
        let mut finite = true;
        if self.recursive {
            finite = self.update_inverse();
        } else {
            self.update_sum();
        }
        self.b.iter_mut().zip(&self.z).for_each(|(sum, trace)| *sum += step.reward * trace);
        if step.is_last() {
            if self.recursive {
                product(&mut values.weights, &self.matrix, &self.b);
            } else {
                self.scratch.copy_from_slice(&self.matrix);
                self.along.copy_from_slice(&self.b);
                finite &= solve(&mut values.weights, &mut self.scratch, &mut self.along);
            }
            finite &= values.weights.iter().all(|weight| weight.is_finite());
        }
        if !finite {
            values.give_up();
        }
    }

    fn work(&self) -> u64 {
        1 + self.matrix.len() as u64 / PRODUCTS_PER_WORK
    }

    fn look_back(&self) -> Option<usize> {
        Some(0)
    }

    fn end_episode(&mut self) {
        self.z.fill(0.0);
    }
}

/// Adds the vector of a state's features to zeros.
fn add_features(vector: &mut [f64], features: &StateFeatures, state: u32) {
    match features.vector(state) {
        Some(x) => vector.copy_from_slice(x),
        None => features.of(state).iter().for_each(|&row| vector[row as usize] += 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::test_support::{last, predictor, step, weighted_predictor};

    fn rule(trace_decay: f64, epsilon: f64, recursive: bool, weights: usize) -> Lstd {
        Lstd::new(trace_decay, epsilon, recursive, weights, &StopFlag::new()).expect("memory suffices")
    }

    #[test]
    fn an_episode_by_hand() {
        // A = 1 + 1 (1 - 0.5 · 2) + 2 · 2 = 5 and b = 3 + 2 · 6 without traces; z = 2 + 0.25 in the second step with them
        for (trace_decay, expected) in [(0.0, 15.0 / 5.0), (0.5, (3.0 + 2.25 * 6.0) / (1.0 + 2.25 * 2.0))] {
            for recursive in [true, false] {
                let mut learner = weighted_predictor(&[0.0], &[1.0, 2.0], rule(trace_decay, 1.0, recursive, 1));
                learner.rule.learn(&mut learner.values, step(0, 3.0, 1));
                assert_eq!(learner.values.weights, [0.0]);
                learner.rule.learn(&mut learner.values, last(1, 6.0));
                assert!((learner.values.weights[0] - expected).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_table_of_many_rows_has_the_averages_of_the_rewards() {
        for recursive in [true, false] {
            let mut learner = predictor(&[0.0; 7], rule(0.0, 1e-9, recursive, 7));
            for reward in [1.0, 3.0] {
                for state in 0..7 {
                    learner.rule.learn(&mut learner.values, last(state, reward * f64::from(state)));
                }
            }
            for (state, value) in learner.values.weights.iter().enumerate() {
                assert!((value - 2.0 * state as f64).abs() < 1e-6, "{value} in {state}");
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_a_divergence() {
        for recursive in [true, false] {
            let mut learner = weighted_predictor(&[0.0], &[1.0, 4.0], rule(0.0, 1.0, recursive, 1));
            // A = 1 + 1 (1 - 0.5 · 4)
            let cut_off = PredictionStep { next: Next::Truncated(1), ..last(0, 0.0) };
            learner.rule.learn(&mut learner.values, cut_off);
            assert!(learner.values.diverged());
        }
    }
}
