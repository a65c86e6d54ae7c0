//! The softmax policy.

use super::Policy;
use super::any_policy::is_available;
use crate::numeric::{maximum, sum};
use crate::random::Rng;

/// The softmax (Boltzmann) policy over the available actions: π(a) ∝ exp(Q(a) / τ) with temperature τ (Sutton & Barto,
/// equation 2.11).
#[derive(Clone, Debug, PartialEq)]
pub struct Softmax {
    temperature: f64,
    /// The values for which π was computed last; NaN before.
    values: Vec<f64>,
    /// The probabilities π for `values`.
    probabilities: Vec<f64>,
    /// A buffer for the gradient.
    gradient: Vec<f64>,
}

impl Softmax {
    /// A policy over `num_actions` actions.
    pub fn new(temperature: f64, num_actions: usize) -> Self {
        let [values, probabilities, gradient] = [f64::NAN, 0.0, 0.0].map(|value| vec![value; num_actions]);
        Self { temperature, values, probabilities, gradient }
    }

    /// π for these action values, which are shifted by their maximum so that `exp` cannot overflow.
    ///
    /// A policy-gradient learner often needs π in the state in which it has just acted, with the same values. Comparing
    /// the values is faster than a single exponential.
    fn probabilities(&mut self, values: &[f64]) -> &[f64] {
        if self.values == values {
            return &self.probabilities;
        }
        self.values.copy_from_slice(values);
        let largest = maximum(values);
        for (probability, value) in self.probabilities.iter_mut().zip(values) {
            *probability = value - largest;
        }
        divide(&mut self.probabilities, self.temperature);
        for probability in &mut self.probabilities {
            // The largest value gives exp(0), which is exactly 1 on every platform. The bits are compared because the
            // compiler would optimize a comparison of floats away and call `exp`.
            *probability = if probability.to_bits() == 0 { 1.0 } else { probability.exp() };
        }
        let total = sum(self.probabilities.iter().copied());
        divide(&mut self.probabilities, total);
        &self.probabilities
    }

    /// The gradient of ln π(A) with respect to the values, which are then preferences: (1 - π(A)) / τ for A, and -π(a)
    /// / τ for any other action (Sutton & Barto, equation 13.9).
    pub(super) fn log_gradient(&mut self, values: &[f64], action: usize) -> &[f64] {
        self.probabilities(values);
        for (part, probability) in self.gradient.iter_mut().zip(&self.probabilities) {
            *part = 0.0 - probability;
        }
        self.gradient[action] = 1.0 - self.probabilities[action];
        divide(&mut self.gradient, self.temperature);
        &self.gradient
    }
}

/// Divides all numbers by the same divisor, and skips a division by 1 to save time.
fn divide(numbers: &mut [f64], divisor: f64) {
    if divisor != 1.0 {
        for number in numbers {
            *number /= divisor;
        }
    }
}

impl Policy for Softmax {
    /// Draws one `random()` and compares it with the cumulative sums of π.
    fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize {
        let threshold = rng.random();
        let mut cumulative = 0.0;
        let probabilities = self.probabilities(values);
        let chosen = probabilities.iter().position(|probability| {
            cumulative += probability;
            threshold < cumulative
        });
        // Rounding can leave the last sum slightly below 1.
        chosen.or_else(|| values.iter().rposition(is_available)).unwrap_or(0)
    }

    fn expected_value(&mut self, values: &[f64]) -> f64 {
        let pairs = self.probabilities(values).iter().zip(values).filter(|(_, value)| is_available(value));
        sum(pairs.map(|(probability, value)| probability * value))
    }

    fn probability(&mut self, values: &[f64], action: usize) -> f64 {
        self.probabilities(values)[action]
    }

    fn end_episode(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn an_unavailable_action_is_neither_chosen_nor_counted() {
        let values = [f64::NEG_INFINITY, 0.5, 0.5, f64::NEG_INFINITY];
        let mut softmax = Softmax::new(1.0, 4);
        assert_eq!(softmax.expected_value(&values), 0.5);
        let mut rng = Pcg64::new(&SeedSequence::new(&[1]));
        assert!((0..100).all(|_| [1, 2].contains(&softmax.choose(&values, &mut rng))));
    }

    #[test]
    fn probabilities_follow_the_values_that_change() {
        let mut softmax = Softmax::new(1.0, 2);
        for values in [[0.0, 0.0], [0.0, 3.0_f64.ln()], [0.0, 0.0]] {
            let expected = Softmax::new(1.0, 2).probabilities(&values).to_vec();
            assert_eq!(softmax.log_gradient(&values, 1), [-expected[0], 1.0 - expected[1]]);
            assert_eq!(softmax.probabilities(&values), expected);
        }
    }

    #[test]
    fn probabilities_are_exponential_in_the_values() {
        let mut softmax = Softmax::new(1.0, 2);
        let expected = softmax.expected_value(&[0.0, 3.0_f64.ln()]);
        assert!((expected - 0.75 * 3.0_f64.ln()).abs() < 1e-15);
    }
}
