//! The softmax policy.

use super::Policy;
use crate::numeric::{maximum, sum};
use crate::random::Rng;

/// The softmax (Boltzmann) policy: π(a) ∝ exp(Q(a) / τ) with the temperature τ (Sutton & Barto, equation 2.11).
#[derive(Clone, Debug, PartialEq)]
pub struct Softmax {
    temperature: f64,
    /// A buffer for π.
    probabilities: Vec<f64>,
}

impl Softmax {
    /// A policy over `num_actions` actions.
    pub fn new(temperature: f64, num_actions: usize) -> Self {
        Self { temperature, probabilities: vec![0.0; num_actions] }
    }

    /// π for these action values, which are shifted by their maximum so that `exp` cannot overflow.
    fn probabilities(&mut self, values: &[f64]) -> &[f64] {
        let largest = maximum(values);
        for (probability, value) in self.probabilities.iter_mut().zip(values) {
            *probability = ((value - largest) / self.temperature).exp();
        }
        let total = sum(self.probabilities.iter().copied());
        for probability in &mut self.probabilities {
            *probability /= total;
        }
        &self.probabilities
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
        chosen.unwrap_or(probabilities.len() - 1)
    }

    fn expected_value(&mut self, values: &[f64]) -> f64 {
        sum(self.probabilities(values).iter().zip(values).map(|(probability, value)| probability * value))
    }

    fn end_episode(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_exponential_in_the_values() {
        let mut softmax = Softmax::new(1.0, 2);
        let expected = softmax.expected_value(&[0.0, 3.0_f64.ln()]);
        assert!((expected - 0.75 * 3.0_f64.ln()).abs() < 1e-15);
    }
}
