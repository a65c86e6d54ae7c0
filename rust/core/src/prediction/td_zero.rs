//! TD(0) (R. Sutton, 1988; Sutton & Barto, equation 6.2 and the box in section 9.3).

use super::{LinearValues, PredictionRule, PredictionStep};

/// w ← w + α [R + γ v(S′) - v(S)] ∇v(S).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TdZero;

impl PredictionRule for TdZero {
    #[inline]
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep) {
        let target = step.reward + values.discount * values.next_value(step.next);
        values.update(step.state, target);
    }

    fn look_back(&self) -> Option<usize> {
        Some(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::test_support::{last, predictor, step};

    #[test]
    fn two_updates_by_hand() {
        let mut learner = predictor(&[1.0, 3.0], TdZero);
        learner.rule.learn(&mut learner.values, step(0, -1.0, 1));
        // 1 + 0.5 (-1 + 0.5 · 3 - 1)
        assert_eq!(learner.values.weights, [0.75, 3.0]);
        learner.rule.learn(&mut learner.values, last(1, 1.0));
        assert_eq!(learner.values.weights, [0.75, 2.0]);
    }
}
