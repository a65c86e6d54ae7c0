//! The learning rate α, chosen at run time.

use super::{Schedule, StepSize, UpdateLog};
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::memory::{AllocationError, filled};

/// A learning rate that follows a schedule, or decreases with the number of visits to each weight.
#[derive(Clone, Debug, PartialEq)]
pub struct LearningRate {
    schedule: Schedule,
    n_active: f64,
    /// The scheduled learning rate divided by `n_active`.
    step_size: f64,
    /// The number of visits to each weight; empty if the learning rate does not depend on visits.
    visits: Vec<u32>,
    min: f64,
    /// The number that divides the step size of each row; empty if all rows share one step size.
    divisors: Vec<f64>,
    /// The step size of each row; empty if all rows share one step size.
    of_rows: Vec<f64>,
    /// Whether `step_size` applies to every weight and updates are not logged.
    uniform: bool,
    log: UpdateLog,
    logs: bool,
}

impl LearningRate {
    /// A learning rate that is the same for every weight. The `n_active` rows of an observation share it equally.
    pub fn scheduled(schedule: Schedule, n_active: usize) -> Self {
        let n_active = n_active as f64;
        Self {
            schedule,
            n_active,
            step_size: schedule.value() / n_active,
            visits: Vec::new(),
            min: 0.0,
            divisors: Vec::new(),
            of_rows: Vec::new(),
            uniform: true,
            log: UpdateLog::default(),
            logs: false,
        }
    }

    /// `initial / n` at the n-th visit to a weight, but at least `min`. With `initial = 1` and `min = 0` a value is the
    /// average of its targets (Sutton & Barto, equation 2.3).
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn by_visit_count(
        initial: f64,
        min: f64,
        weights: usize,
        n_active: usize,
        stop: &StopFlag<'_>,
    ) -> Result<Self, AllocationError> {
        let visits = filled(&0, weights, stop)?;
        Ok(Self { visits, min, uniform: false, ..Self::scheduled(Schedule::constant(initial), n_active) })
    }

    /// A learning rate for weighted features, divided by a number for each row: αᵢ = α / dᵢ.
    #[must_use]
    pub fn scaled_by_row(schedule: Schedule, divisors: Vec<f64>) -> Self {
        let of_rows = divisors.iter().map(|divisor| schedule.value() / divisor).collect();
        Self { of_rows, divisors, uniform: false, ..Self::scheduled(schedule, 1) }
    }

    /// The step size that all weights share, if it does not depend on visits or on the row.
    #[inline(always)]
    pub(crate) fn shared(&self) -> f64 {
        self.step_size
    }

    /// The step size of a row, if it does not depend on visits.
    #[inline(always)]
    pub(crate) fn of_row(&self, row: usize) -> f64 {
        self.of_rows.get(row).copied().unwrap_or(self.step_size)
    }

    /// The step sizes of another learning rate, divided as this one: the one that all rows share, and those of the rows,
    /// empty if they share one.
    pub(crate) fn divided(&self, learning_rate: f64) -> (f64, Vec<f64>) {
        let of_rows = self.divisors.iter().map(|divisor| learning_rate / divisor).collect();
        (learning_rate / self.n_active, of_rows)
    }

    /// The number of active rows of an observation, which share the learning rate.
    pub fn n_active(&self) -> f64 {
        self.n_active
    }

    /// Turns the logging of updates with this learning rate on or off. It does not affect the updates. Updates of
    /// traces are not logged.
    pub fn set_logging(&mut self, logs: bool) {
        self.logs = logs;
        self.uniform = self.visits.is_empty() && self.of_rows.is_empty() && !logs;
    }

    /// The logged updates.
    pub fn logged(&mut self) -> &mut UpdateLog {
        &mut self.log
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
    fn uniform(&self) -> Option<f64> {
        self.uniform.then_some(self.step_size)
    }

    #[inline]
    fn at(&self, weight_index: usize) -> f64 {
        match self.visits.get(weight_index) {
            None => self.step_size,
            Some(&visits) => (self.schedule.value() / f64::from(visits)).max(self.min) / self.n_active,
        }
    }

    #[inline]
    fn of_rows(&self) -> Option<&[f64]> {
        (!self.of_rows.is_empty()).then_some(&self.of_rows[..])
    }

    fn end_episode(&mut self) {
        if !self.schedule.is_final() {
            self.schedule.end_episode();
            self.step_size = self.schedule.value() / self.n_active;
            for (step, divisor) in self.of_rows.iter_mut().zip(&self.divisors) {
                *step = self.schedule.value() / divisor;
            }
        }
    }

    #[inline]
    fn log(&mut self) -> Option<&mut UpdateLog> {
        self.logs.then_some(&mut self.log)
    }

    fn persist_counts(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.visits.persist(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn active_rows_share_the_learning_rate() {
        assert_eq!(LearningRate::scheduled(Schedule::constant(0.5), 8).at(3), 0.0625);
    }

    #[test]
    fn the_step_size_of_each_row_follows_the_schedule() {
        let mut rate = LearningRate::scaled_by_row(Schedule::linear(0.5, 0.1, 4, 0), vec![1.0, 2.0, 0.5]);
        assert_eq!((rate.uniform(), rate.of_rows()), (None, Some([0.5, 0.25, 1.0].as_slice())));
        rate.end_episode();
        let step = 0.5 - 0.4 / 4.0;
        assert_eq!(rate.of_rows(), Some([step, step / 2.0, step / 0.5].as_slice()));
    }

    #[test]
    fn each_weight_counts_its_visits() {
        let mut rate = LearningRate::by_visit_count(1.0, 0.3, 2, 1, &StopFlag::new()).expect("two weights");
        rate.visit(0);
        rate.visit(1);
        rate.visit(1);
        assert_eq!((rate.at(0), rate.at(1)), (1.0, 0.5));
        rate.visit(1);
        rate.visit(1);
        assert_eq!(rate.at(1), 0.3);
    }
}
