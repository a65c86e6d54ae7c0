//! Off-policy semi-gradient TD(0) (Sutton & Barto, equation 11.2).

use super::feature_counts::FeatureCounts;
use crate::prediction::{LinearValues, PredictionRule, PredictionStep};

/// w ← w + α ρ δ ∇v(S) with ρ = π(A|S) / b(A|S) and δ = R + γ v(S′) - v(S). It may diverge with function approximation.
#[derive(Clone, Debug, PartialEq)]
pub struct OffPolicyTd {
    counts: FeatureCounts,
}

impl OffPolicyTd {
    /// `weights` is the number of weights.
    pub fn new(weights: usize) -> Self {
        Self { counts: FeatureCounts::new(weights) }
    }
}

impl PredictionRule for OffPolicyTd {
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep) {
        let error = values.td_error(step.state, step.reward, step.next);
        let LinearValues { weights, features, learning_rate, .. } = values;
        self.counts.for_each(features, step.state, None, |row, x, _| {
            weights[row] += learning_rate.of_row(row) * step.ratio * error * x;
        });
    }

    fn look_back(&self) -> Option<usize> {
        Some(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::test_support::{step, weighted_predictor};

    /// Section 11.2: two states with the values w and 2w.
    #[test]
    fn w_grows_by_the_ratio() {
        let mut learner = weighted_predictor(&[10.0], &[1.0, 2.0], OffPolicyTd::new(1));
        learner.values.discount = 0.75;
        learner.rule.learn(&mut learner.values, PredictionStep { ratio: 2.0, ..step(0, 0.0, 1) });
        // δ = 0.75 · 20 - 10
        assert_eq!(learner.values.weights, [15.0]);
    }
}
