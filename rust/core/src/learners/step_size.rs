//! How far an update moves a weight: the learning rate, shared among the rows that an observation lights.

use super::Schedule;

/// The step size of a weight. A weight is counted rows first: `row * actions + action`.
pub trait StepSize {
    /// A weight's value is about to be corrected because its pair was visited.
    fn visit(&mut self, weight: usize);

    /// The step size of a weight now: the learning rate over the number of rows lit.
    fn at(&self, weight: usize) -> f64;

    /// Called after every episode.
    fn end_episode(&mut self);
}

/// The same for every weight and episode.
impl StepSize for f64 {
    #[inline]
    fn visit(&mut self, _weight: usize) {}

    #[inline]
    fn at(&self, _weight: usize) -> f64 {
        *self
    }

    fn end_episode(&mut self) {}
}

/// The same for every weight, of a lone row each, and another after every episode.
impl StepSize for Schedule {
    #[inline]
    fn visit(&mut self, _weight: usize) {}

    #[inline]
    fn at(&self, _weight: usize) -> f64 {
        self.value()
    }

    fn end_episode(&mut self) {
        Schedule::end_episode(self);
    }
}

/// A learning rate by a schedule, or by the number of visits.
#[derive(Clone, Debug, PartialEq)]
pub struct Rate {
    schedule: Schedule,
    lit: f64,
    step: f64,
    /// Empty where the rate does not depend on them.
    visits: Vec<u32>,
    least: f64,
}

impl Rate {
    /// The same for every weight; `lit` rows share it.
    pub fn scheduled(schedule: Schedule, lit: usize) -> Self {
        let lit = lit as f64;
        Self { schedule, lit, step: schedule.value() / lit, visits: Vec::new(), least: 0.0 }
    }

    /// `first` / n at the n-th visit of a weight, but no less than `least`: with `first` = 1 a value is the average of
    /// its targets (Sutton & Barto, equation 2.3).
    pub fn by_visits(first: f64, least: f64, weights: usize, lit: usize) -> Self {
        Self { visits: vec![0; weights], least, ..Self::scheduled(Schedule::constant(first), lit) }
    }

    /// The step size of every weight, where it is the same.
    #[inline]
    pub fn shared(&self) -> Option<f64> {
        self.visits.is_empty().then_some(self.step)
    }
}

impl StepSize for Rate {
    #[inline]
    fn visit(&mut self, weight: usize) {
        if let Some(visits) = self.visits.get_mut(weight) {
            *visits = visits.saturating_add(1);
        }
    }

    #[inline]
    fn at(&self, weight: usize) -> f64 {
        match self.visits.get(weight) {
            None => self.step,
            Some(&visits) => (self.schedule.value() / f64::from(visits)).max(self.least) / self.lit,
        }
    }

    fn end_episode(&mut self) {
        self.schedule.end_episode();
        self.step = self.schedule.value() / self.lit;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rows_lit_share_the_learning_rate() {
        assert_eq!(Rate::scheduled(Schedule::constant(0.5), 8).at(3), 0.0625);
    }

    #[test]
    fn visits_divide_the_rate_weight_by_weight() {
        let mut rate = Rate::by_visits(1.0, 0.3, 2, 1);
        rate.visit(0);
        rate.visit(1);
        rate.visit(1);
        assert_eq!((rate.at(0), rate.at(1)), (1.0, 0.5));
        rate.visit(1);
        rate.visit(1);
        assert_eq!(rate.at(1), 0.3);
    }
}
