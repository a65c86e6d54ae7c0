//! How far an update moves a weight: the learning rate, shared among the rows that an observation lights.

use super::Schedule;

/// The step size of a weight. A weight is counted rows first: `row * actions + action`.
pub trait StepSize {
    /// A weight's value is about to be corrected because its pair was visited.
    fn visit(&mut self, weight_index: usize);

    /// The step size of a weight now: the learning rate over the number of rows lit.
    fn at(&self, weight_index: usize) -> f64;

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
