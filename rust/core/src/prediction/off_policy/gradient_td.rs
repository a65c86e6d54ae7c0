//! Gradient TD: GTD2 and TDC (R. Sutton, H. Maei and others, "Fast gradient-descent methods for temporal-difference learning
//! with linear function approximation", 2009; Sutton & Barto, section 11.7).

use super::feature_counts::FeatureCounts;
use crate::prediction::{LinearValues, PredictionRule, PredictionStep};
use crate::schedules::LearningRate;
use crate::tasks::Next;

/// The update of the weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GradientTdKind {
    /// w ← w + α ρ (x - γ x′) xᵀv
    Gtd2,
    /// w ← w + α ρ (δ x - γ x′ xᵀv)
    Tdc,
}

/// Gradient descent on the projected Bellman error, with a second weight vector v, the ratio ρ = π(A|S) / b(A|S) and the TD
/// error δ = R + γ wᵀx′ - wᵀx:
///
/// - w as in [`GradientTdKind`]
/// - v ← v + β ρ (δ - vᵀx) x
///
/// Both use the old w and v. At first v is 0.
#[derive(Clone, Debug, PartialEq)]
pub struct GradientTd {
    kind: GradientTdKind,
    v: Vec<f64>,
    /// β.
    second_rate: LearningRate,
    counts: FeatureCounts,
}

impl GradientTd {
    /// `second_rate` is β, in the form of the learning rate of the weights, and `weights` their number.
    pub fn new(kind: GradientTdKind, second_rate: LearningRate, weights: usize) -> Self {
        Self { kind, v: vec![0.0; weights], second_rate, counts: FeatureCounts::new(weights) }
    }
}

impl PredictionRule for GradientTd {
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep) {
        let error = values.td_error(step.state, step.reward, step.next);
        let correction = values.features.dot(step.state, &self.v);
        values.check_finite(correction);
        let next = match step.next {
            Next::NonTerminal(next) | Next::Truncated(next) => Some(next),
            Next::Terminal => None,
        };
        let LinearValues { weights, features, learning_rate, discount, .. } = values;
        let Self { kind, v, second_rate, counts } = self;
        let ratio = step.ratio;
        counts.for_each(features, step.state, next, |row, x, next_x| {
            let change = learning_rate.of_row(row) * ratio;
            weights[row] += match kind {
                GradientTdKind::Gtd2 => change * (x - *discount * next_x) * correction,
                GradientTdKind::Tdc => change * (error * x - *discount * next_x * correction),
            };
            v[row] += second_rate.of_row(row) * ratio * (error - correction) * x;
        });
    }

    fn look_back(&self) -> Option<usize> {
        Some(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::test_support::{last, predictor, step};
    use crate::schedules::Schedule;

    fn rule(kind: GradientTdKind) -> GradientTd {
        GradientTd::new(kind, LearningRate::scheduled(Schedule::constant(0.25), 1), 2)
    }

    #[test]
    fn two_steps_by_hand() {
        // δ = -1 + 0.5 · 3 - 1 and ρ = 2: v = 0.25 · 2 · -0.5; then xᵀv = -0.25 for GTD2, and δ = -1 - 0.5 for TDC
        for (kind, first, second) in
            [(GradientTdKind::Gtd2, 1.0, 1.0 + 0.5 * -0.25), (GradientTdKind::Tdc, 0.5, 0.5 + 0.5 * -1.5)]
        {
            let mut learner = predictor(&[1.0, 3.0], rule(kind));
            learner.rule.learn(&mut learner.values, PredictionStep { ratio: 2.0, ..step(0, -1.0, 1) });
            assert_eq!((&learner.values.weights, &learner.rule.v), (&vec![first, 3.0], &vec![-0.25, 0.0]));
            learner.rule.learn(&mut learner.values, last(0, -1.0));
            assert_eq!(learner.values.weights, [second, 3.0]);
        }
    }

    #[test]
    fn the_next_state_is_corrected() {
        let mut learner = predictor(&[0.0, 0.0], rule(GradientTdKind::Tdc));
        learner.rule.v = vec![4.0, 0.0];
        learner.rule.learn(&mut learner.values, step(0, 1.0, 1));
        // δ = 1 and xᵀv = 4: w = (0.5, -0.5 · 0.5 · 4), v = 4 + 0.25 (1 - 4)
        assert_eq!(learner.values.weights, [0.5, -1.0]);
        assert_eq!(learner.rule.v, [3.25, 0.0]);
    }
}
