//! True online TD(λ), with dutch traces (H. van Seijen and R. Sutton, 2014; Sutton & Barto, the box in section 12.5).

use super::StateTraces;
use crate::numeric::sum_products;
use crate::prediction::{LinearValues, PredictionRule, PredictionStep};

/// With the weights w, the traces z, the features x of S, V = wᵀx and V′ = wᵀx′:
///
/// - δ = R + γ V′ - V
/// - z ← γλ z + (1 - αγλ zᵀx) x
/// - w ← w + α (δ + V - Vₒ) z - α (V - Vₒ) x
/// - Vₒ ← V′
///
/// If each weighted feature i has its own step size αᵢ, then α zᵀx is Σᵢ αᵢ zᵢ xᵢ: the method is the same for the features √αᵢ
/// xᵢ with a step size of 1.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueOnlineTdLambda {
    trace_decay: f64,
    traces: StateTraces,
    v_old: f64,
}

impl TrueOnlineTdLambda {
    /// `trace_decay` is λ, and `weights` the number of weights.
    pub fn new(trace_decay: f64, weights: usize) -> Self {
        Self { trace_decay, traces: StateTraces::new(weights), v_old: 0.0 }
    }

    /// αγλ zᵀx.
    fn reduction(&self, values: &LinearValues, state: u32, decay: f64) -> f64 {
        let traces = &self.traces.values;
        if let Some(x) = values.features.vector(state) {
            return decay * sum_products(x, |row| [values.learning_rate.of_row(row) * traces[row]])[0];
        }
        let overlap = values.features.of(state).iter().fold(0.0, |sum, &row| sum + traces[row as usize]);
        values.learning_rate.shared() * decay * overlap
    }
}

impl PredictionRule for TrueOnlineTdLambda {
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep) {
        let next_value = values.next_value(step.next);
        let value = values.value(step.state);
        let error = step.reward + values.discount * next_value - value;
        values.check_finite(error);
        let decay = values.discount * self.trace_decay;
        let reduction = self.reduction(values, step.state, decay);
        self.traces.multiply(decay);
        self.traces.add(&values.features, step.state, 1.0 - reduction);
        let change = value - self.v_old;
        let LinearValues { weights, features, learning_rate, .. } = values;
        self.traces.apply(weights, learning_rate, error + change);
        if let Some(x) = features.vector(step.state) {
            for (row, (weight, x)) in weights.iter_mut().zip(x).enumerate() {
                *weight -= learning_rate.of_row(row) * change * x;
            }
        } else {
            let reduced = learning_rate.shared() * change;
            for &row in features.of(step.state) {
                weights[row as usize] -= reduced;
            }
        }
        self.v_old = next_value;
    }

    fn work(&self) -> u64 {
        self.traces.work()
    }

    fn look_back(&self) -> Option<usize> {
        Some(0)
    }

    fn end_episode(&mut self) {
        self.v_old = 0.0;
        self.traces.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::test_support::{last, predictor, step};

    #[test]
    fn an_episode_by_hand() {
        let mut learner = predictor(&[1.0, 3.0], TrueOnlineTdLambda::new(0.5, 2));
        // z = 1; δ = -1 + 0.5 · 3 - 1; 1 + 0.5 (δ + 1 - 0) - 0.5 (1 - 0)
        learner.rule.learn(&mut learner.values, step(0, -1.0, 1));
        assert_eq!(learner.values.weights, [0.75, 3.0]);
        // z = 1/4 and 1, V = V_old = 3; δ = -1 - 3
        learner.rule.learn(&mut learner.values, last(1, -1.0));
        assert_eq!(learner.values.weights, [0.25, 1.0]);
    }
}
