//! The off-line λ-return algorithm (Sutton & Barto, equations 12.2 to 12.4).

use super::episode::Episode;
use super::{LinearValues, PredictionRule, PredictionStep, RowSets};
use crate::memory::{AllocationError, RunMemory};

/// w ← w + α [Gₜ - v(Sₜ)] ∇v(Sₜ) at the end of an episode, for its steps from the first to the last, where Gₜ is the
/// λ-return from the values before these updates.
#[derive(Clone, Debug, PartialEq)]
pub struct OfflineLambdaReturn {
    trace_decay: f64,
    episode: Episode,
}

impl OfflineLambdaReturn {
    /// `trace_decay` is λ, and `states` the number of states.
    pub fn new(trace_decay: f64, states: usize) -> Self {
        Self { trace_decay, episode: Episode::new(states) }
    }
}

impl<S: RowSets> PredictionRule<S> for OfflineLambdaReturn {
    fn learn(&mut self, values: &mut LinearValues<S>, step: PredictionStep) {
        if !self.episode.push(step) {
            return;
        }
        self.episode.compute_returns(values, step.next, self.trace_decay);
        for (visit, &target) in self.episode.visits.iter().zip(&self.episode.returns) {
            values.update(visit.state, target);
        }
        self.episode.clear();
    }

    fn work(&self) -> u64 {
        self.episode.work()
    }

    fn reserve(&mut self, steps: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        self.episode.reserve(steps, memory)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::test_support::{last, predictor, step};

    #[test]
    fn an_episode_by_hand() {
        let mut learner = predictor(&[1.0, 2.0], OfflineLambdaReturn::new(0.5, 2));
        learner.rule.learn(&mut learner.values, step(0, 1.0, 1));
        learner.rule.learn(&mut learner.values, last(1, 4.0));
        // G₁ = 4 and G₀ = 1 + 0.5 (0.5 · 2 + 0.5 · 4)
        assert_eq!(learner.values.weights, [1.75, 3.0]);
    }
}
