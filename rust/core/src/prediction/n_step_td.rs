//! n-step TD prediction (Sutton & Barto, equations 7.1 and 7.2, and the box in section 7.1).

use std::collections::VecDeque;

use super::{LinearValues, PredictionRule, PredictionStep};
use crate::memory::{AllocationError, RunMemory};
use crate::tasks::Next;

/// w ← w + α [G - v(Sₜ)] ∇v(Sₜ) with the n-step return G = Rₜ₊₁ + γ Rₜ₊₂ + … + γⁿ⁻¹ Rₜ₊ₙ + γⁿ v(Sₜ₊ₙ).
///
/// The sum runs from left to right, and the powers of γ are a running product. At the end of an episode the last n states
/// are updated with shorter returns.
#[derive(Clone, Debug, PartialEq)]
pub struct NStepTd {
    n: usize,
    /// The states waiting for their updates, and the rewards that followed, oldest first, at most n.
    visits: VecDeque<(u32, f64)>,
    work: u64,
}

impl NStepTd {
    /// n-step TD with returns of `n` rewards.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn new(n: usize) -> Self {
        assert!(n > 0, "n_steps must be at least 1, got 0");
        Self { n, visits: VecDeque::new(), work: 1 }
    }

    /// Updates the oldest state. `bootstrap` is the value of the state after the newest reward, if it is not terminal.
    fn update_oldest(&mut self, values: &mut LinearValues, bootstrap: Option<u32>) {
        let (mut target, mut power) = (0.0, 1.0);
        for (_, reward) in &self.visits {
            target += power * reward;
            power *= values.discount;
        }
        if let Some(state) = bootstrap {
            target += power * values.value(state);
        }
        self.work += self.visits.len() as u64 / 8;
        if let Some((state, _)) = self.visits.pop_front() {
            values.update(state, target);
        }
    }
}

impl PredictionRule for NStepTd {
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep) {
        self.work = 1;
        self.visits.push_back((step.state, step.reward));
        match step.next {
            Next::NonTerminal(next) => {
                if self.visits.len() == self.n {
                    self.update_oldest(values, Some(next));
                }
            }
            Next::Truncated(_) | Next::Terminal => {
                let bootstrap = if let Next::Truncated(next) = step.next { Some(next) } else { None };
                while !self.visits.is_empty() {
                    self.update_oldest(values, bootstrap);
                }
            }
        }
    }

    fn work(&self) -> u64 {
        self.work
    }

    fn look_back(&self) -> Option<usize> {
        Some(self.n)
    }

    /// At most n states wait.
    fn reserve(&mut self, steps: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        let count = ((self.n - self.visits.len()) as u64).min(steps) as usize;
        memory.reserve(&mut self.visits, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::test_support::{last, predictor, step};

    #[test]
    fn an_episode_by_hand() {
        let mut learner = predictor(&[1.0, 2.0, 8.0], NStepTd::new(2));
        learner.rule.learn(&mut learner.values, step(0, -1.0, 1));
        assert_eq!(learner.values.weights, [1.0, 2.0, 8.0]);
        learner.rule.learn(&mut learner.values, step(1, -2.0, 2));
        // 1 + 0.5 (-1 + 0.5 · -2 + 0.25 · 8 - 1)
        assert_eq!(learner.values.weights, [0.5, 2.0, 8.0]);
        learner.rule.learn(&mut learner.values, last(2, 4.0));
        // 2 + 0.5 (-2 + 0.5 · 4 - 2), then 8 + 0.5 (4 - 8)
        assert_eq!(learner.values.weights, [0.5, 1.0, 6.0]);
    }
}
