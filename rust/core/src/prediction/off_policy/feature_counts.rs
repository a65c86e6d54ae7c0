//! The values of the features of a state and the next one, weight by weight.

use crate::prediction::StateFeatures;

/// For each weight, the numbers of times that a binary feature occurs in a state and in the next one; 0 between the calls.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FeatureCounts(Vec<[f64; 2]>);

impl FeatureCounts {
    /// `weights` is the number of weights of binary features.
    pub(super) fn new(weights: usize) -> Self {
        Self(vec![[0.0; 2]; weights])
    }

    /// Calls a function with the index i of each weight and the values xᵢ(S) and xᵢ(S′), of which binary features skip those
    /// where both are 0. Without a next state, xᵢ(S′) is 0.
    #[inline]
    pub(super) fn for_each(
        &mut self,
        features: &StateFeatures,
        state: u32,
        next: Option<u32>,
        mut visit: impl FnMut(usize, f64, f64),
    ) {
        if let Some(x) = features.vector(state) {
            match next.and_then(|next| features.vector(next)) {
                Some(next_x) => x.iter().zip(next_x).enumerate().for_each(|(row, (&x, &next))| visit(row, x, next)),
                None => x.iter().enumerate().for_each(|(row, &x)| visit(row, x, 0.0)),
            }
            return;
        }
        let (rows, next_rows) = (features.of(state), next.map_or(&[][..], |next| features.of(next)));
        for (index, rows) in [rows, next_rows].into_iter().enumerate() {
            for &row in rows {
                self.0[row as usize][index] += 1.0;
            }
        }
        for &row in rows.iter().chain(next_rows) {
            let [x, next] = std::mem::take(&mut self.0[row as usize]);
            if x != 0.0 || next != 0.0 {
                visit(row as usize, x, next);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_feature_that_is_listed_twice_counts_twice() {
        let rows = vec![3, 1, 3, 0, 1, 1];
        let Some(features) = StateFeatures::of_states(rows, 3, 4) else { unreachable!("they fit") };
        let mut counts = FeatureCounts::new(4);
        for _ in 0..2 {
            let mut found = Vec::new();
            counts.for_each(&features, 0, Some(1), |row, x, next| found.push((row, x, next)));
            assert_eq!(found, [(3, 2.0, 0.0), (1, 1.0, 2.0), (0, 0.0, 1.0)]);
        }
    }
}
