//! Sampling from a distribution over outcomes, as `gymnasium.envs.toy_text.utils.categorical_sample` does.

use std::ops::Range;

use crate::random::TWO_POW_53;

/// Up to this many thresholds are stored inline. Gymnasium's tables need no more.
const LINEAR_SCAN_MAX: usize = 3;
/// A threshold above every draw.
pub(super) const ABOVE_ALL: u64 = TWO_POW_53 as u64;

/// The distribution over the outcomes of a state and an action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OutcomeDistribution {
    /// The thresholds if there are few, padded with `ABOVE_ALL`. The next state depends on them, so they are stored
    /// here rather than behind an index.
    inline_thresholds: [u64; LINEAR_SCAN_MAX],
    /// The index of the first outcome.
    first: u32,
    len: u32,
}

impl OutcomeDistribution {
    /// A distribution with these thresholds. `first` is the index of its first outcome among all outcomes of the table.
    pub(super) fn new(thresholds: &[u64], first: usize) -> Self {
        let mut inline_thresholds = [ABOVE_ALL; LINEAR_SCAN_MAX];
        inline_thresholds.iter_mut().zip(thresholds).for_each(|(inline, &threshold)| *inline = threshold);
        Self { inline_thresholds, first: first as u32, len: thresholds.len() as u32 }
    }

    /// The indices of this distribution's outcomes among all outcomes of the table.
    pub(super) fn range(&self) -> Range<usize> {
        self.first as usize..self.first as usize + self.len as usize
    }

    /// The index, among all outcomes of the table, of the outcome that the draw `u53` selects. `thresholds` are those
    /// of the whole table. A draw at or above all thresholds selects the first outcome, as in Gymnasium.
    #[expect(clippy::inline_always, reason = "a call per step would take a fifth of its time")]
    #[inline(always)]
    pub(super) fn sample(&self, thresholds: &[u64], u53: u64) -> usize {
        let (first, len) = (self.first as usize, self.len as usize);
        let rank = if len <= LINEAR_SCAN_MAX {
            // Counting avoids a branch, which would often be mispredicted.
            self.inline_thresholds.iter().map(|&threshold| usize::from(threshold <= u53)).sum()
        } else {
            thresholds[first..][..len].partition_point(|&threshold| threshold <= u53)
        };
        if rank < len { first + rank } else { first }
    }
}

/// The threshold of each outcome, in units of 2⁻⁵³ like `Rng::random_u53`: a draw below it selects this outcome or an
/// earlier one. The threshold is the cumulative probability, summed from left to right as `np.cumsum` does. A running
/// maximum keeps the thresholds ascending even if the sums are not.
pub(super) fn thresholds(probabilities: &[f64]) -> Vec<u64> {
    let (mut sum, mut largest) = (0.0, f64::NEG_INFINITY);
    let thresholds = probabilities.iter().map(|probability| {
        sum += probability;
        largest = sum.max(largest);
        // Multiplying by a power of two is exact.
        (largest * TWO_POW_53).ceil() as u64
    });
    thresholds.collect()
}
