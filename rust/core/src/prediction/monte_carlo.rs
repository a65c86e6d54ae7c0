//! Monte Carlo prediction (Sutton & Barto, the boxes in sections 5.1 and 9.3, and equation 6.1).

use super::episode::Episode;
use super::{LinearValues, PredictionRule, PredictionStep, RowSets};
use crate::memory::{AllocationError, RunMemory};

/// w ← w + α [Gₜ - v(Sₜ)] ∇v(Sₜ) at the end of an episode, for its steps from the first to the last. With a learning rate
/// of 1 / n at the n-th visit, the values of a table are the averages of the returns.
#[derive(Clone, Debug, PartialEq)]
pub struct MonteCarloPrediction {
    first_visit: bool,
    episode: Episode,
}

impl MonteCarloPrediction {
    /// With `first_visit`, a state learns only from its first visit in an episode. `states` is their number.
    pub fn new(first_visit: bool, states: usize) -> Self {
        Self { first_visit, episode: Episode::new(states) }
    }
}

impl<S: RowSets> PredictionRule<S> for MonteCarloPrediction {
    #[inline]
    fn learn(&mut self, values: &mut LinearValues<S>, step: PredictionStep) {
        if !self.episode.push(step) {
            return;
        }
        self.episode.compute_returns(values, step.next, 1.0);
        for (visit, &target) in self.episode.visits.iter().zip(&self.episode.returns) {
            if visit.first || !self.first_visit {
                values.update(visit.state, target);
            }
        }
        self.episode.clear();
    }

    #[inline]
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
    fn first_visits_ignore_later_ones() {
        for (first_visit, value) in [(true, 1.0), (false, 2.5)] {
            let mut learner = predictor(&[1.0, 0.0], MonteCarloPrediction::new(first_visit, 2));
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
