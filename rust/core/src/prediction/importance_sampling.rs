//! Off-policy Monte Carlo prediction by importance sampling (Sutton & Barto, equations 5.3 to 5.8).

use super::episode::Episode;
use super::{FixedPolicy, LinearValues, PredictionRule, PredictionStep, RowSets};
use crate::memory::{AllocationError, RunMemory};

/// π(A|S) / b(A|S) of the steps of an episode.
#[derive(Clone, Debug, PartialEq)]
pub enum Ratios {
    /// Of policies over numbered states.
    OfTables {
        /// π.
        target: FixedPolicy,
        /// b.
        behavior: FixedPolicy,
    },
    /// As the policies gave them, step by step; empty before the first step.
    Given(Vec<f64>),
}

/// At the end of an episode, for its steps from the last to the first, with the importance-sampling ratio
/// ρ = Π π(A|S) / b(A|S) from that step on:
///
/// - ordinary: C ← C + 1, v(S) ← v(S) + (ρ G - v(S)) / C
/// - weighted: C ← C + ρ, v(S) ← v(S) + ρ / C (G - v(S))
#[derive(Clone, Debug, PartialEq)]
pub struct ImportanceSampling {
    weighted: bool,
    first_visit: bool,
    ratios: Ratios,
    /// C of each row.
    weights: Vec<f64>,
    episode: Episode,
}

impl ImportanceSampling {
    /// Estimates the values of a target policy from episodes of another one. `shape` is the number of states and of rows.
    pub fn new(weighted: bool, first_visit: bool, ratios: Ratios, (states, rows): (usize, usize)) -> Self {
        Self { weighted, first_visit, ratios, weights: vec![0.0; rows], episode: Episode::new(states) }
    }
}

impl<S: RowSets> PredictionRule<S> for ImportanceSampling {
    #[inline]
    fn learn(&mut self, values: &mut LinearValues<S>, step: PredictionStep) {
        if !self.episode.push(step) {
            return;
        }
        self.episode.compute_returns(values, step.next, 1.0);
        let mut ratio = 1.0;
        for (index, (visit, &target)) in self.episode.visits.iter().zip(&self.episode.returns).enumerate().rev() {
            ratio *= match &self.ratios {
                Ratios::OfTables { target, behavior } => {
                    let action = visit.action as usize;
                    target.probability(visit.state, action) / behavior.probability(visit.state, action)
                }
                Ratios::Given(ratios) => ratios[index],
            };
            if self.first_visit && !visit.first {
                continue;
            }
            let row = values.rows.first(visit.state);
            let error = if self.weighted {
                if ratio == 0.0 {
                    break; // all ratios before it are 0, too
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
        if let Ratios::Given(ratios) = &mut self.ratios {
            ratios.clear();
        }
    }

    fn weigh(&mut self, ratio: f64) {
        if let Ratios::Given(ratios) = &mut self.ratios {
            ratios.push(ratio);
        }
    }

    #[inline]
    fn work(&self) -> u64 {
        self.episode.work()
    }

    fn reserve(&mut self, steps: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        if let Ratios::Given(ratios) = &mut self.ratios {
            memory.reserve(ratios, usize::try_from(steps).unwrap_or(usize::MAX))?;
        }
        self.episode.reserve(steps, memory)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prediction::test_support::predictor;
    use crate::tasks::Next;

    #[test]
    fn two_episodes_by_hand() {
        for (weighted, values) in [(false, [3.0, 1.5]), (true, [3.0, 3.0])] {
            let (target, behavior) = (FixedPolicy::new([1.0, 0.0].into(), 2), FixedPolicy::new([0.5, 0.5].into(), 2));
            let rule = ImportanceSampling::new(weighted, true, Ratios::OfTables { target, behavior }, (1, 1));
            let mut learner = predictor(&[0.0], rule);
            let rewards = if weighted { [3.0, 9.0] } else { [1.5, 9.0] };
            // The target policy takes the first action only, so ρ is 2 and then 0.
            for ((action, reward), value) in rewards.into_iter().enumerate().zip(values) {
                let step = PredictionStep { state: 0, action, reward, next: Next::Terminal };
                learner.rule.learn(&mut learner.values, step);
                assert_eq!(learner.values.weights, [value]);
            }
        }
    }
}
