//! The off-line λ-return algorithm (Sutton & Barto, equations 12.2 to 12.4). With λ = 1 it is Monte Carlo prediction
//! (the boxes in sections 5.1 and 9.3, and equation 6.1).

use super::episode::Episode;
use super::{LinearValues, PredictionRule, PredictionStep};
use crate::memory::{AllocationError, RunMemory};

/// w ← w + α [Gₜ - v(Sₜ)] ∇v(Sₜ) at the end of an episode, for its steps from the first to the last, where Gₜ is the
/// λ-return from the values before these updates, or with λ = 1 the return. With a learning rate of 1 / n at the n-th
/// visit, the values of a table are then the averages of the returns.
#[derive(Clone, Debug, PartialEq)]
pub struct OfflineLambdaReturn {
    trace_decay: f64,
    first_visit: bool,
    episode: Episode,
}

impl OfflineLambdaReturn {
    /// `trace_decay` is λ, and `states` the number of states; 0 if they are not numbered.
    pub fn new(trace_decay: f64, states: usize) -> Self {
        Self { trace_decay, first_visit: false, episode: Episode::new(states) }
    }

    /// Monte Carlo prediction. With `first_visit`, a state learns only from its first visit in an episode.
    pub fn monte_carlo(first_visit: bool, states: usize) -> Self {
        Self { first_visit, ..Self::new(1.0, states) }
    }
}

impl PredictionRule for OfflineLambdaReturn {
    #[inline]
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep) {
        if !self.episode.push(step) {
            return;
        }
        self.episode.compute_returns(values, step.next, self.trace_decay);
        let every_visit = !self.first_visit;
        for (visit, &target) in self.episode.visits.iter().zip(&self.episode.returns) {
            if every_visit || visit.first {
                values.update(visit.state, target);
            }
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

    #[test]
    fn monte_carlo_ignores_later_visits_if_the_first_counts() {
        for (first_visit, value) in [(true, 1.0), (false, 2.5)] {
            let mut learner = predictor(&[1.0, 0.0], OfflineLambdaReturn::monte_carlo(first_visit, 2));
            for episode in 0..2 {
                learner.values.weights = vec![1.0, 0.0];
                learner.rule.learn(&mut learner.values, step(0, -1.0, 0));
                assert_eq!(learner.values.weights, [1.0, 0.0], "episode {episode}");
                learner.rule.learn(&mut learner.values, last(0, 4.0));
                // The returns are 1 and 4: 1 + 0.5 (1 - 1), then 1 + 0.5 (4 - 1)
                assert_eq!(learner.values.weights, [value, 0.0]);
            }
        }
    }
}
