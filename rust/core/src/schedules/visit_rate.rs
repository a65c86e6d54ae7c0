//! The learning rate of averages, for one active row.

use super::StepSize;
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::memory::{AllocationError, filled};

/// `initial / n` at the n-th visit of a weight, but at least `min`: [`LearningRate::by_visit_count`] for one active row,
/// without what a step size that is chosen at run time has to ask.
///
/// [`LearningRate::by_visit_count`]: super::LearningRate::by_visit_count
#[derive(Clone, Debug, PartialEq)]
pub struct VisitRate {
    initial: f64,
    min: f64,
    /// The number of visits of each weight.
    visits: Vec<u32>,
}

impl VisitRate {
    /// For so many weights.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(initial: f64, min: f64, weights: usize, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        Ok(Self { initial, min, visits: filled(&0, weights, stop)? })
    }
}

impl StepSize for VisitRate {
    #[inline]
    fn visit(&mut self, weight_index: usize) {
        let visits = &mut self.visits[weight_index];
        *visits = visits.saturating_add(1);
    }

    #[inline]
    fn uniform(&self) -> Option<f64> {
        None
    }

    #[inline]
    fn at(&self, weight_index: usize) -> f64 {
        let rate = self.initial / f64::from(self.visits[weight_index]);
        // One instruction, unlike `f64::max`, which minds NaN.
        if self.min > rate { self.min } else { rate }
    }

    #[inline]
    fn end_episode(&mut self) {}

    fn persist_counts(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.visits.persist(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedules::LearningRate;

    #[test]
    fn it_is_the_learning_rate_by_visits() {
        let stop = StopFlag::new();
        let mut rate = VisitRate::new(0.7, 0.2, 2, &stop).expect("two weights");
        let mut expected = LearningRate::by_visit_count(0.7, 0.2, 2, 1, &stop).expect("two weights");
        for weight in [0, 1, 1, 0, 1, 1, 1] {
            rate.visit(weight);
            expected.visit(weight);
            assert_eq!((rate.at(weight), rate.uniform()), (expected.at(weight), expected.uniform()));
        }
    }
}
