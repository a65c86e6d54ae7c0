//! The learning rate α, chosen at run time.

use super::{Schedule, StepSize};

/// A learning rate by a schedule, or by the number of visits.
#[derive(Clone, Debug, PartialEq)]
pub struct LearningRate {
    schedule: Schedule,
    n_active: f64,
    step: f64,
    /// Empty where the rate does not depend on them.
    visits: Vec<u32>,
    min: f64,
}

impl LearningRate {
    /// The same for every weight; `lit` rows share it.
    pub fn scheduled(schedule: Schedule, n_active: usize) -> Self {
        let n_active = n_active as f64;
        Self { schedule, n_active, step: schedule.value() / n_active, visits: Vec::new(), min: 0.0 }
    }

    /// `first` / n at the n-th visit of a weight, but no less than `least`: with `first` = 1 a value is the average of
    /// its targets (Sutton & Barto, equation 2.3).
    pub fn by_visit_count(first: f64, min: f64, weights: usize, n_active: usize) -> Self {
        Self { visits: vec![0; weights], min, ..Self::scheduled(Schedule::constant(first), n_active) }
    }

    /// The step size of every weight, where it is the same.
    #[inline]
    pub fn uniform(&self) -> Option<f64> {
        self.visits.is_empty().then_some(self.step)
    }
}

impl StepSize for LearningRate {
    #[inline]
    fn visit(&mut self, weight_index: usize) {
        if let Some(visits) = self.visits.get_mut(weight_index) {
            *visits = visits.saturating_add(1);
        }
    }

    #[inline]
    fn at(&self, weight_index: usize) -> f64 {
        match self.visits.get(weight_index) {
            None => self.step,
            Some(&visits) => (self.schedule.value() / f64::from(visits)).max(self.min) / self.n_active,
        }
    }

    fn end_episode(&mut self) {
        self.schedule.end_episode();
        self.step = self.schedule.value() / self.n_active;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rows_lit_share_the_learning_rate() {
        assert_eq!(LearningRate::scheduled(Schedule::constant(0.5), 8).at(3), 0.0625);
    }

    #[test]
    fn visits_divide_the_rate_weight_by_weight() {
        let mut rate = LearningRate::by_visit_count(1.0, 0.3, 2, 1);
        rate.visit(0);
        rate.visit(1);
        rate.visit(1);
        assert_eq!((rate.at(0), rate.at(1)), (1.0, 0.5));
        rate.visit(1);
        rate.visit(1);
        assert_eq!(rate.at(1), 0.3);
    }
}
