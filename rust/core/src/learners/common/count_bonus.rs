//! The count-based exploration bonus (A. Strehl & M. Littman, 2008: model-based interval estimation with exploration
//! bonus).

use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::memory::{AllocationError, filled};

/// The learner receives R + β / √N(S, A) instead of R, where N counts the visits to the pair, including the current
/// one. With several active rows, each of which has a count, the bonus is the average over the rows.
#[derive(Clone, Debug, PartialEq)]
pub struct CountBonus {
    /// The weight β.
    weight: f64,
    num_actions: usize,
    /// The counts N of each row and action.
    counts: Vec<u32>,
}

impl CountBonus {
    /// Counts for a table with these numbers of rows and actions.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(weight: f64, (rows, num_actions): (usize, usize), stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        Ok(Self { weight, num_actions, counts: filled(&0, rows * num_actions, stop)? })
    }

    /// Counts a visit and returns its bonus.
    pub(in crate::learners) fn visit(&mut self, rows: &[u32], action: usize) -> f64 {
        let mut sum = 0.0;
        for &row in rows {
            let count = &mut self.counts[row as usize * self.num_actions + action];
            *count = count.saturating_add(1);
            sum += self.weight / f64::from(*count).sqrt();
        }
        sum / rows.len() as f64
    }
}

/// The counts.
impl Persist for CountBonus {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.counts.persist(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bonus_falls_with_the_visits() {
        let mut bonus = CountBonus::new(6.0, (2, 2), &StopFlag::new()).expect("a few counts");
        assert_eq!(
            [bonus.visit(&[0], 1), bonus.visit(&[0, 1], 1), bonus.visit(&[0], 0)].map(f64::floor),
            [6.0, 5.0, 6.0]
        );
        bonus.visit(&[0], 1);
        assert_eq!(bonus.visit(&[0], 1), 3.0);
    }
}
