//! Values with round numbers, for updates computed by hand.

use super::{FixedPolicy, LinearValues, PredictionStep, Predictor, StateFeatures};
use crate::random::{Pcg64, SeedSequence};
use crate::schedules::{LearningRate, Schedule};
use crate::tasks::Next;

/// A table with α = γ = 1/2, and a policy of one action.
pub(super) fn predictor<U>(values: &[f64], rule: U) -> Predictor<U> {
    let rows = (0..values.len() as u32).collect();
    let rows = StateFeatures::of_states(rows, 1, values.len()).expect("a row for each state");
    with_features(values, rows, rule)
}

/// Weights of weighted features, those of state 0 first, with the same α, γ and policy.
pub(super) fn weighted_predictor<U>(weights: &[f64], vectors: &[f64], rule: U) -> Predictor<U> {
    let features = StateFeatures::weighted(vectors.to_vec(), weights.len()).expect("a vector for each state");
    with_features(weights, features, rule)
}

fn with_features<U>(weights: &[f64], features: StateFeatures, rule: U) -> Predictor<U> {
    let behavior = FixedPolicy::new(vec![1.0; features.num_states()].into(), 1);
    let rate = LearningRate::scheduled(Schedule::constant(0.5), 1);
    let values = LinearValues::new(weights.to_vec(), features, rate, 0.5);
    Predictor::new(values, behavior, Box::new(rule))
}

/// A step to another state.
pub(super) fn step(state: u32, reward: f64, next: u32) -> PredictionStep {
    PredictionStep { state, reward, next: Next::NonTerminal(next), ratio: 1.0 }
}

/// The last step of an episode.
pub(super) fn last(state: u32, reward: f64) -> PredictionStep {
    PredictionStep { state, reward, next: Next::Terminal, ratio: 1.0 }
}

/// The generator of seed 0.
pub(super) fn rng() -> Pcg64 {
    Pcg64::new(&SeedSequence::new(&[0]))
}
