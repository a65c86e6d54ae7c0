//! TD(λ) with accumulating traces (R. Sutton, 1988; Sutton & Barto, the box in section 12.2).

use super::{LinearValues, PredictionRule, PredictionStep, RowSets};
use crate::tasks::Next;

/// The traces z of all weights, and which of them may not be zero.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StateTraces {
    pub(super) values: Vec<f64>,
    eligible: Vec<u32>,
    is_eligible: Vec<bool>,
}

impl StateTraces {
    pub(super) fn new(weights: usize) -> Self {
        Self { values: vec![0.0; weights], eligible: Vec::with_capacity(weights), is_eligible: vec![false; weights] }
    }

    /// Adds to the trace of a weight.
    #[inline]
    pub(super) fn add(&mut self, row: u32, increment: f64) {
        if !std::mem::replace(&mut self.is_eligible[row as usize], true) {
            self.eligible.push(row);
        }
        self.values[row as usize] += increment;
    }

    /// Multiplies all traces by a factor.
    #[inline]
    pub(super) fn decay(&mut self, factor: f64) {
        for &row in &self.eligible {
            self.values[row as usize] *= factor;
        }
    }

    /// w ← w + step z.
    #[inline]
    pub(super) fn apply(&self, weights: &mut [f64], step: f64) {
        for &row in &self.eligible {
            weights[row as usize] += step * self.values[row as usize];
        }
    }

    /// z ← 0.
    pub(super) fn clear(&mut self) {
        for row in self.eligible.drain(..) {
            self.values[row as usize] = 0.0;
            self.is_eligible[row as usize] = false;
        }
    }

    /// The work of a pass.
    #[inline]
    pub(super) fn work(&self) -> u64 {
        1 + self.eligible.len() as u64 / 4
    }
}

/// With the weights w and the traces z, which start at 0 in each episode:
///
/// - z ← γλ z + ∇v(S)
/// - δ = R + γ v(S′) - v(S)
/// - w ← w + α δ z
#[derive(Clone, Debug, PartialEq)]
pub struct TdLambda {
    trace_decay: f64,
    traces: StateTraces,
}

impl TdLambda {
    /// `trace_decay` is λ, and `weights` the number of weights.
    pub fn new(trace_decay: f64, weights: usize) -> Self {
        Self { trace_decay, traces: StateTraces::new(weights) }
    }
}

impl<S: RowSets> PredictionRule<S> for TdLambda {
    fn learn(&mut self, values: &mut LinearValues<S>, step: PredictionStep) {
        self.traces.decay(values.discount * self.trace_decay);
        for &row in values.rows.of(step.state) {
            self.traces.add(row, 1.0);
        }
        let target = match step.next {
            Next::NonTerminal(next) | Next::Truncated(next) => step.reward + values.discount * values.value(next),
            Next::Terminal => step.reward,
        };
        let error = target - values.value(step.state);
        values.check_finite(error);
        let step_size = values.step_size();
        self.traces.apply(&mut values.weights, step_size * error);
    }

    fn work(&self) -> u64 {
        self.traces.work()
    }

    fn look_back(&self) -> Option<usize> {
        Some(0)
    }

    fn end_episode(&mut self, _values: &mut LinearValues<S>) {
        self.traces.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::test_support::{last, predictor, step};

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
}
