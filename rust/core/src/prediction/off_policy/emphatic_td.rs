//! One-step emphatic TD (R. Sutton, A. Mahmood and M. White, 2016; Sutton & Barto, section 11.8).

use super::feature_counts::FeatureCounts;
use crate::prediction::{LinearValues, PredictionRule, PredictionStep};

/// With the emphasis M, an interest of 1 in every state, and the ratios ρ = π(A|S) / b(A|S) of this step and ρ₋ of the step
/// before:
///
/// - M ← γ ρ₋ M + 1, where M is 1 in the first state of an episode
/// - δ = R + γ v(S′) - v(S)
/// - w ← w + α M ρ δ ∇v(S)
#[derive(Clone, Debug, PartialEq)]
pub struct EmphaticTd {
    counts: FeatureCounts,
    emphasis: f64,
    last_ratio: f64,
}

impl EmphaticTd {
    /// `weights` is the number of weights.
    pub fn new(weights: usize) -> Self {
        Self { counts: FeatureCounts::new(weights), emphasis: 0.0, last_ratio: 0.0 }
    }
}

impl PredictionRule for EmphaticTd {
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep) {
        self.emphasis = values.discount * self.last_ratio * self.emphasis + 1.0;
        self.last_ratio = step.ratio;
        values.check_finite(self.emphasis);
        let error = values.td_error(step.state, step.reward, step.next);
        let LinearValues { weights, features, learning_rate, .. } = values;
        self.counts.for_each(features, step.state, None, |row, x, _| {
            weights[row] += learning_rate.of_row(row) * self.emphasis * step.ratio * error * x;
        });
    }

    fn look_back(&self) -> Option<usize> {
        Some(0)
    }

    fn end_episode(&mut self) {
        (self.emphasis, self.last_ratio) = (0.0, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::test_support::{last, predictor, step};

    #[test]
    fn an_episode_begins_with_an_emphasis_of_one() {
        let mut learner = predictor(&[0.0, 0.0], EmphaticTd::new(2));
        for expected in [[1.0, 1.0], [1.5, 1.5]] {
            learner.rule.learn(&mut learner.values, PredictionStep { ratio: 2.0, ..step(0, 1.0, 0) });
            // M = 1: 0 + 0.5 · 2 · 1, then 1 + 0.5 · 2 (1 + 0.5 - 1)
            assert_eq!(learner.values.weights[0], expected[0]);
            learner.rule.learn(&mut learner.values, PredictionStep { ratio: 0.5, ..last(1, 2.0) });
            // M = 0.5 · 2 · 1 + 1: 0 + 0.5 · 2 · 0.5 · 2, then 1 + 0.5 · 2 · 0.5 (2 - 1)
            assert_eq!(learner.values.weights[1], expected[1]);
            learner.rule.end_episode();
        }
    }
}
