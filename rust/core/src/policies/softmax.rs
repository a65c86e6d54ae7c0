//! Softmax over action values.

use crate::numeric::{maximum, sum};
use crate::random::Rng;

/// Each action by exp(Q / τ), shifted by the largest value so that nothing overflows.
#[derive(Clone, Debug, PartialEq)]
pub struct Softmax {
    pub(super) temperature: f64,
    pub(super) shares: Vec<f64>,
}

impl Softmax {
    pub(super) fn shares(&mut self, values: &[f64]) -> &[f64] {
        let largest = maximum(values);
        for (share, value) in self.shares.iter_mut().zip(values) {
            *share = ((value - largest) / self.temperature).exp();
        }
        let total = sum(self.shares.iter().copied());
        for share in &mut self.shares {
            *share /= total;
        }
        &self.shares
    }

    pub(super) fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize {
        let drawn = rng.random();
        let mut reached = 0.0;
        let shares = self.shares(values);
        // Rounding may leave the last sum a little below one.
        let chosen = shares.iter().position(|share| {
            reached += share;
            drawn < reached
        });
        chosen.unwrap_or(shares.len() - 1)
    }
}
