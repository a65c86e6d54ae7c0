//! Off-policy Monte Carlo prediction by importance sampling (Sutton & Barto, equations 5.3 to 5.8).

use crate::memory::{AllocationError, RunMemory};
use crate::prediction::episode::Episode;
use crate::prediction::{LinearValues, PredictionRule, PredictionStep};

/// Updates at the end of an episode, for its steps from the last to the first, with the importance-sampling ratio ρ = Π
/// π(A|S) / b(A|S) from that step on:
///
/// - ordinary: C ← C + 1, v(S) ← v(S) + (ρ G - v(S)) / C
/// - weighted: C ← C + ρ, v(S) ← v(S) + ρ / C (G - v(S))
#[derive(Clone, Debug, PartialEq)]
pub struct ImportanceSampling {
    weighted: bool,
    first_visit: bool,
    /// C of each row.
    weights: Vec<f64>,
    episode: Episode,
    /// π(A|S) / b(A|S) of each step of the episode.
    ratios: Vec<f64>,
}

impl ImportanceSampling {
    /// Estimates the values of a target policy from episodes of a behavior policy. `shape` is the number of states and
    /// of rows.
    pub fn new(weighted: bool, first_visit: bool, (states, rows): (usize, usize)) -> Self {
        Self { weighted, first_visit, weights: vec![0.0; rows], episode: Episode::new(states), ratios: Vec::new() }
    }
}

impl PredictionRule for ImportanceSampling {
    #[inline]
    fn learn(&mut self, values: &mut LinearValues, step: PredictionStep) {
        self.ratios.push(step.ratio);
        if !self.episode.push(step) {
            return;
        }
        self.episode.compute_returns(values, step.next, 1.0);
        let mut ratio = 1.0;
        let steps = self.episode.visits.iter().zip(&self.episode.returns).zip(&self.ratios);
        for ((visit, &target), step_ratio) in steps.rev() {
            ratio *= step_ratio;
            if self.first_visit && !visit.first {
                continue;
            }
            let row = values.features.first(visit.state);
            let error = if self.weighted {
                if ratio == 0.0 {
                    break; // the ratios of all earlier steps are 0, too
                }
                self.weights[row] += ratio;
                ratio / self.weights[row] * (target - values.weights[row])
            } else {
                self.weights[row] += 1.0;
                (ratio * target - values.weights[row]) / self.weights[row]
            };
            values.check_finite(error);
            values.weights[row] += error;
        }
        self.episode.clear();
        self.ratios.clear();
    }

    #[inline]
    fn work(&self) -> u64 {
        self.episode.work()
    }

    fn reserve(&mut self, steps: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        memory.reserve(&mut self.ratios, usize::try_from(steps).unwrap_or(usize::MAX))?;
        self.episode.reserve(steps, memory)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::test_support::{last, predictor};

    #[test]
    fn two_episodes_by_hand() {
        for (weighted, values) in [(false, [3.0, 1.5]), (true, [3.0, 3.0])] {
            let rule = ImportanceSampling::new(weighted, true, (1, 1));
            let mut learner = predictor(&[0.0], rule);
            let rewards = if weighted { [3.0, 9.0] } else { [1.5, 9.0] };
            for ((ratio, reward), value) in [2.0, 0.0].into_iter().zip(rewards).zip(values) {
                learner.rule.learn(&mut learner.values, PredictionStep { ratio, ..last(0, reward) });
                assert_eq!(learner.values.weights, [value]);
            }
        }
    }
}
