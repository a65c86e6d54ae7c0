//! Which of several outcomes a draw takes.

use std::ops::Range;

use crate::random::TWO_POW_53;

/// So many bounds are kept beside each other: those of Gymnasium's tables.
const LINEAR_SCAN_MAX: usize = 3;
/// Above every draw.
const ABOVE: u64 = TWO_POW_53 as u64;

/// The outcomes of a state and an action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OutcomeDistribution {
    /// Their bounds, where they are few: at hand, for the next state waits for them. What no draw passes fills up.
    few: [u64; LINEAR_SCAN_MAX],
    first: u32,
    outcomes: u32,
}

impl OutcomeDistribution {
    /// Outcomes with these bounds, which begin at `first` among those of all rows.
    pub(super) fn new(bounds: &[u64], first: usize) -> Self {
        let mut few = [ABOVE; LINEAR_SCAN_MAX];
        few.iter_mut().zip(bounds).for_each(|(few, &bound)| *few = bound);
        Self { few, first: first as u32, outcomes: bounds.len() as u32 }
    }

    /// Its outcomes among those of all rows.
    pub(super) fn range(&self) -> Range<usize> {
        self.first as usize..self.first as usize + self.outcomes as usize
    }

    /// The outcome that a draw takes, among those of all rows, whose `bounds` these are: the first of the row where it
    /// passes all.
    #[expect(clippy::inline_always, reason = "a call a step costs a fifth of it")]
    #[inline(always)]
    pub(super) fn sample(&self, bounds: &[u64], u53: u64) -> usize {
        let (first, outcomes) = (self.first as usize, self.outcomes as usize);
        let rank = if outcomes <= LINEAR_SCAN_MAX {
            // Counted without a branch, which would often be mispredicted.
            self.few.iter().map(|&bound| usize::from(bound <= u53)).sum()
        } else {
            rank(&bounds[first..][..outcomes], u53)
        };
        if rank < outcomes { first + rank } else { first }
    }
}

/// How many bounds a draw passes; they never fall.
#[inline]
pub(super) fn rank(bounds: &[u64], u53: u64) -> usize {
    bounds.partition_point(|&bound| bound <= u53)
}

/// For each probability the least draw that passes it by, `random()` in units of 2⁻⁵³: where the largest sum so far is
/// no longer above it. The sums are added from left to right as `np.cumsum` does, and the largest never fall, which sums
/// of any floats might.
pub(super) fn bounds(probabilities: &[f64]) -> Vec<u64> {
    let (mut sum, mut largest) = (0.0, f64::NEG_INFINITY);
    let bounds = probabilities.iter().map(|probability| {
        sum += probability;
        largest = sum.max(largest);
        // Exact: a multiplication by a power of two.
        (largest * TWO_POW_53).ceil() as u64
    });
    bounds.collect()
}
