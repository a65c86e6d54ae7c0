//! Distributions for the tests of tables.

use proptest::prelude::*;

/// Probabilities of fewer than `end` outcomes. Some are 0, but not all, and they may sum to slightly less than 1.
pub(super) fn probabilities(weight: impl Strategy<Value = f64>, end: usize) -> impl Strategy<Value = Vec<f64>> {
    let short = prop_oneof![Just(0.0), 0.0..1e-10];
    (prop::collection::vec(weight, 1..end), short).prop_map(|(mut weights, short)| {
        if weights.iter().all(|&weight| weight == 0.0) {
            weights[0] = 1.0;
        }
        let total: f64 = weights.iter().sum();
        weights.iter().map(|weight| weight / total * (1.0 - short)).collect()
    })
}
