//! Off-policy TD(λ) with importance sampling (Sutton & Barto, equations 12.23 to 12.25).

use super::StateTraces;
use crate::prediction::{LinearValues, PredictionRule, PredictionStep};

/// With the weights w, the traces z, which start at 0 in each episode, and the ratio ρ = π(A|S) / b(A|S):
///
/// - z ← ρ (γλ z + ∇v(S))
/// - δ = R + γ v(S′) - v(S)
/// - w ← w + α δ z
///
/// It may diverge, as all off-policy semi-gradient methods with function approximation.
#[derive(Clone, Debug, PartialEq)]
pub struct OffPolicyTdLambda {
    trace_decay: f64,
    traces: StateTraces,
}

impl OffPolicyTdLambda {
    /// `trace_decay` is λ, and `weights` the number of weights.
    pub fn new(trace_decay: f64, weights: usize) -> Self {
        Self { trace_decay, traces: StateTraces::new(weights) }
    }
}

impl PredictionRule for OffPolicyTdLambda {
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep) {
        self.traces.multiply(values.discount * self.trace_decay);
        self.traces.add(&values.features, step.state, 1.0);
        self.traces.multiply(step.ratio);
        let error = values.td_error(step.state, step.reward, step.next);
        self.traces.apply(&mut values.weights, &values.learning_rate, error);
    }

    fn work(&self) -> u64 {
        self.traces.work()
    }

    fn look_back(&self) -> Option<usize> {
        Some(0)
    }

    fn end_episode(&mut self) {
        self.traces.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::test_support::{last, predictor, step};

    #[test]
    fn an_episode_by_hand() {
        let mut learner = predictor(&[1.0, 3.0], OffPolicyTdLambda::new(0.5, 2));
        learner.rule.learn(&mut learner.values, PredictionStep { ratio: 2.0, ..step(0, -1.0, 1) });
        // z = 2; δ = -1 + 0.5 · 3 - 1
        assert_eq!(learner.values.weights, [0.5, 3.0]);
        learner.rule.learn(&mut learner.values, PredictionStep { ratio: 0.5, ..last(1, -1.0) });
        // z = 0.5 · 0.25 · 2 and 0.5; δ = -1 - 3
        assert_eq!(learner.values.weights, [0.0, 2.0]);
    }
}
