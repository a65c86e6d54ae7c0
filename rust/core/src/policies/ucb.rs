//! Upper-confidence-bound action selection.

use super::TieBreaking;
use super::any_policy::is_available;
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::memory::{AllocationError, filled};
use crate::numeric::{argmax, sum};
use crate::random::Rng;

/// Chooses argmaxₐ [Q(S, a) + c √(ln t / N(S, a))] (Sutton & Barto, equation 2.10), where N(S, a) is the number of
/// times that a was chosen in S, and t is one more than the sum of these numbers over all actions. An action that was
/// never chosen comes first.
#[derive(Clone, Debug, PartialEq)]
pub struct Ucb {
    confidence: f64,
    ties: TieBreaking,
    /// The counts N(S, a), row by row.
    counts: Vec<u32>,
    /// A buffer for the bounds.
    bounds: Vec<f64>,
}

impl Ucb {
    /// A policy with the degree of exploration c, for a table with these numbers of rows and actions.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(
        confidence: f64,
        ties: TieBreaking,
        (n_rows, num_actions): (usize, usize),
        stop: &StopFlag<'_>,
    ) -> Result<Self, AllocationError> {
        let counts = filled(&0, n_rows * num_actions, stop)?;
        Ok(Self { confidence, ties, counts, bounds: vec![0.0; num_actions] })
    }

    /// The upper bounds of the values.
    #[inline]
    fn bounds(&mut self, row: u32, values: &[f64]) -> &[f64] {
        let counts = &self.counts[row as usize * self.bounds.len()..][..self.bounds.len()];
        let time = 1 + counts.iter().map(|&count| u64::from(count)).sum::<u64>();
        let log = (time as f64).ln();
        for ((bound, &count), &value) in self.bounds.iter_mut().zip(counts).zip(values) {
            *bound = upper_bound(self.confidence, log, count, value);
        }
        &self.bounds
    }

    /// The action with the largest bound. The choice is counted. Draws one `integers` to break a tie at random.
    #[inline]
    pub(super) fn choose(&mut self, row: u32, values: &[f64], rng: &mut impl Rng) -> usize {
        let ties = self.ties;
        let action = ties.greedy(self.bounds(row, values), rng);
        let count = &mut self.counts[row as usize * values.len() + action];
        *count = count.saturating_add(1);
        action
    }

    /// The value of the action with the largest bound; or the mean over the actions that may be chosen in a tie.
    pub(super) fn expected_value(&mut self, row: u32, values: &[f64]) -> f64 {
        let ties = self.ties;
        let bounds = self.bounds(row, values);
        let best = argmax(bounds);
        if ties == TieBreaking::First {
            return values[best];
        }
        let largest = bounds[best];
        let share = 1.0 / bounds.iter().filter(|&&bound| bound == largest).count() as f64;
        sum(bounds.iter().zip(values).filter(|(bound, _)| **bound == largest).map(|(_, value)| share * value))
    }

    pub(super) fn persist_counts(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.counts.persist(checkpoint)
    }
}

/// The upper bound of a value: ∞ for an action that was never chosen, -∞ for an unavailable one.
#[inline]
fn upper_bound(confidence: f64, log: f64, count: u32, value: f64) -> f64 {
    match count {
        0 if is_available(&value) => f64::INFINITY,
        0 => f64::NEG_INFINITY,
        count => value + confidence * (log / f64::from(count)).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    fn ucb() -> Ucb {
        Ucb::new(2.0, TieBreaking::First, (1, 3), &StopFlag::new()).expect("three counts")
    }

    #[test]
    fn each_action_is_tried_before_any_is_repeated() {
        let (mut ucb, mut rng) = (ucb(), Pcg64::new(&SeedSequence::new(&[1])));
        let actions = [(); 4].map(|()| ucb.choose(0, &[0.0, 9.0, 1.0], &mut rng));
        assert_eq!(actions, [0, 1, 2, 1]);
    }

    #[test]
    fn rarely_chosen_actions_have_larger_bounds() {
        let mut ucb = ucb();
        ucb.counts = vec![100, 4, 0];
        let bounds = ucb.bounds(0, &[1.0, 0.0, f64::NEG_INFINITY]).to_vec();
        let log = 105_f64.ln();
        assert_eq!(bounds, [1.0 + 2.0 * (log / 100.0).sqrt(), 2.0 * (log / 4.0).sqrt(), f64::NEG_INFINITY]);
        assert_eq!(ucb.expected_value(0, &[1.0, 0.0, f64::NEG_INFINITY]), 0.0);
    }
}
