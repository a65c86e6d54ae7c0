//! Sampling the initial state of an episode, as `gymnasium.envs.toy_text.utils.categorical_sample` does.

use std::sync::Arc;

use super::outcome_distribution::{ABOVE_ALL, thresholds};

/// The distribution of the initial state.
///
/// A guide table shortens the search: the range of draws is divided into equal parts, as many as there are states or a
/// few more, and the search begins at the first state of the draw's part. On average it then takes at most one more
/// step (L. Devroye, "Non-Uniform Random Variate Generation", 1986, section III.2.4).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct InitialStates {
    probabilities: Arc<[f64]>,
    thresholds: Arc<[u64]>,
    /// The state of the first draw of each part; the number of parts is a power of two.
    first_states: Arc<[u32]>,
    /// The right shift, in bits, that turns a draw into the index of its part.
    shift: u32,
}

impl InitialStates {
    /// A distribution with these probabilities, one for each state.
    pub(super) fn new(probabilities: &[f64]) -> Self {
        let thresholds = thresholds(probabilities);
        let parts = probabilities.len().next_power_of_two() as u64;
        let (part_size, mut state) = (ABOVE_ALL / parts, 0);
        let first_states = (0..parts).map(|part| {
            state += thresholds[state..].iter().take_while(|&&threshold| threshold <= part * part_size).count();
            state as u32
        });
        let first_states = first_states.collect();
        Self {
            probabilities: probabilities.into(),
            thresholds: thresholds.into(),
            first_states,
            shift: part_size.ilog2(),
        }
    }

    /// The probability of each state.
    pub(super) fn probabilities(&self) -> &[f64] {
        &self.probabilities
    }

    /// The state that a draw of 53 bits selects. A draw at or above all thresholds selects the first state, as in
    /// Gymnasium.
    #[inline]
    pub(super) fn sample(&self, u53: u64) -> u32 {
        let mut state = self.first_states[(u53 >> self.shift) as usize];
        while let Some(&threshold) = self.thresholds.get(state as usize) {
            if threshold > u53 {
                return state;
            }
            state += 1;
        }
        0
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::envs::tabular::test_support::probabilities;

    proptest! {
        #[test]
        fn the_guide_table_changes_no_state(
            probabilities in probabilities(prop_oneof![0.0..1.0, Just(0.0), Just(1e-9)], 40),
            draws in prop::collection::vec(0..ABOVE_ALL, 20),
        ) {
            let (states, thresholds) = (InitialStates::new(&probabilities), thresholds(&probabilities));
            // Draws next to a threshold, and those at the ends of the parts, matter most.
            let parts = (0..64).map(|part| part << 47);
            let edges = thresholds.iter().copied().chain(parts).flat_map(|edge| [edge.saturating_sub(1), edge]);
            for draw in draws.into_iter().chain(edges).filter(|&draw| draw < ABOVE_ALL) {
                let expected = thresholds.iter().position(|&threshold| threshold > draw).unwrap_or(0);
                prop_assert_eq!(states.sample(draw), expected as u32);
            }
        }
    }
}
