//! TD(λ) with accumulating traces (R. Sutton, 1988; Sutton & Barto, the box in section 12.2), and off-policy with importance
//! sampling (equations 12.23 to 12.25).

use super::StateTraces;
use crate::prediction::{LinearValues, PredictionRule, PredictionStep};

/// With the weights w and the traces z, which start at 0 in each episode:
///
/// - z ← γλ z + ∇v(S), times the ratio ρ = π(A|S) / b(A|S) if `OFF_POLICY`
/// - δ = R + γ v(S′) - v(S)
/// - w ← w + α δ z
///
/// Off-policy it may diverge, as all semi-gradient methods with function approximation.
#[derive(Clone, Debug, PartialEq)]
pub struct TdLambda<const OFF_POLICY: bool = false> {
    trace_decay: f64,
    traces: StateTraces,
}

impl TdLambda {
    /// `trace_decay` is λ, and `weights` the number of weights.
    pub fn new(trace_decay: f64, weights: usize) -> Self {
        Self { trace_decay, traces: StateTraces::new(weights) }
    }
}

impl TdLambda<true> {
    /// Off-policy TD(λ). `trace_decay` is λ, and `weights` the number of weights.
    pub fn off_policy(trace_decay: f64, weights: usize) -> Self {
        Self { trace_decay, traces: StateTraces::new(weights) }
    }
}

impl<const OFF_POLICY: bool> PredictionRule for TdLambda<OFF_POLICY> {
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep) {
        self.traces.multiply(values.discount * self.trace_decay);
        self.traces.add(&values.features, step.state, 1.0);
        if OFF_POLICY {
            self.traces.multiply(step.ratio);
        }
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
    use crate::prediction::test_support::{last, predictor, step, weighted_predictor};

    #[test]
    fn an_episode_by_hand() {
        let mut learner = predictor(&[1.0, 3.0], TdLambda::new(0.5, 2));
        learner.rule.learn(&mut learner.values, step(0, -1.0, 1));
        // δ = -1 + 0.5 · 3 - 1
        assert_eq!(learner.values.weights, [0.75, 3.0]);
        learner.rule.learn(&mut learner.values, last(1, -1.0));
        // δ = -1 - 3, and the trace of state 0 is 1/4
        assert_eq!(learner.values.weights, [0.25, 1.0]);
    }

    #[test]
    fn an_off_policy_episode_by_hand() {
        let mut learner = predictor(&[1.0, 3.0], TdLambda::off_policy(0.5, 2));
        learner.rule.learn(&mut learner.values, PredictionStep { ratio: 2.0, ..step(0, -1.0, 1) });
        // z = 2; δ = -1 + 0.5 · 3 - 1
        assert_eq!(learner.values.weights, [0.5, 3.0]);
        learner.rule.learn(&mut learner.values, PredictionStep { ratio: 0.5, ..last(1, -1.0) });
        // z = 0.5 · 0.25 · 2 and 0.5; δ = -1 - 3
        assert_eq!(learner.values.weights, [0.0, 2.0]);
    }

    #[test]
    fn vectors_by_hand() {
        // x = (1, 2) in state 0 and (0, 4) in state 1; v = wᵀx
        let mut learner = weighted_predictor(&[1.0, 0.5], &[1.0, 2.0, 0.0, 4.0], TdLambda::new(0.5, 2));
        learner.rule.learn(&mut learner.values, step(0, -1.0, 1));
        // z = (1, 2); δ = -1 + 0.5 · 2 - 2
        assert_eq!(learner.values.weights, [0.0, -1.5]);
        learner.rule.learn(&mut learner.values, last(1, -4.0));
        // z = (1/4, 4.5); δ = -4 - 4 · -1.5
        assert_eq!(learner.values.weights, [0.25, 3.0]);
    }
}
