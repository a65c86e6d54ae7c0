//! The visits of the last steps. A replacing trace depends on the number of steps since its last visit alone, so the
//! visits tell which traces can fall to the cutoff, and no pass has to look for them.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use crate::memory::{AllocationError, with_capacity};

/// Room for the visits of 455 steps with 8 active rows, in which a trace falls to a cutoff of 0.001 if γλ is at most 0.984.
const CAPACITY: usize = 4096;

/// The most rows of a visit: the bits of a mask.
const MAX_ROWS: usize = u64::BITS as usize;

/// More steps than a trace can last.
const ALWAYS: usize = usize::MAX / 2;

/// The state-action pairs visited in the last steps, as long as a visit sets their traces to 1, and each step ends by a decay
/// of all traces by the same factor.
#[derive(Clone, Debug)]
pub(super) struct RecentVisits {
    /// For each of the last visits the active rows and the action; as many visits as a trace lasts steps. Empty if visits are
    /// not remembered; without room if there is no cutoff.
    visits: Vec<u32>,
    /// The number of active rows of a visit; 0 if traces do not change by visits that set them to 1.
    num_rows: usize,
    /// Where the next visit goes, in place of the oldest one.
    next: usize,
    /// γλ, by which the traces decay.
    factor: f64,
    /// The number of steps that a trace lasts: in which 1 decays to the cutoff.
    lifetime: usize,
    /// For how many steps all visits have been remembered.
    steps: usize,
    /// Whether there has been a visit in this step.
    visited: bool,
}

impl RecentVisits {
    /// No visits. Without a cutoff none will be remembered.
    pub(super) fn new(cutoff: f64) -> Result<Self, AllocationError> {
        let visits = with_capacity(if cutoff > 0.0 { CAPACITY } else { 0 })?;
        Ok(Self { visits, num_rows: 0, next: 0, factor: f64::NAN, lifetime: 0, steps: ALWAYS, visited: false })
    }

    /// A visit, which sets the traces of a state-action pair to 1.
    // It keeps rows: with weights the compiler would compute them in a vector register and take them out of it one by one.
    #[inline(always)]
    pub(super) fn visit(&mut self, rows: &[u32], action: u32) {
        if self.visits.capacity() == 0 {
            return;
        }
        if rows.len() != self.num_rows || self.visited {
            self.expect_rows(rows.len());
        }
        self.visited = true;
        if !self.visits.is_empty() {
            let visit = &mut self.visits[self.next..];
            visit[..self.num_rows].copy_from_slice(rows);
            visit[self.num_rows] = action;
        }
    }

    #[cold]
    fn expect_rows(&mut self, num_rows: usize) {
        self.invalidate();
        self.num_rows = num_rows;
        self.factor = f64::NAN;
    }

    /// Traces change in another way than by one visit in a step, which sets them to 1.
    #[inline(always)]
    pub(super) fn invalidate(&mut self) {
        self.visits.clear();
        self.num_rows = 0;
        self.visited = false;
    }

    /// All traces become 0.
    pub(super) fn clear(&mut self) {
        self.steps = ALWAYS;
        self.visited = false;
    }

    /// Ends a step by a decay. Returns the only visit whose traces it can take to the cutoff; `None` if that is not known.
    #[inline(always)]
    pub(super) fn end_step(&mut self, factor: f64) -> Option<usize> {
        if self.visits.capacity() == 0 {
            return None;
        }
        self.visited = false;
        if factor.to_bits() != self.factor.to_bits() {
            self.visits.clear();
        }
        if self.visits.is_empty() {
            return None;
        }
        self.next += self.num_rows + 1;
        if self.next == self.visits.len() {
            self.next = 0;
        }
        // The traces from before those steps have all fallen.
        let complete = self.steps >= self.lifetime;
        self.steps += 1;
        complete.then_some(self.next)
    }

    /// The active rows and the action of a visit.
    #[inline(always)]
    pub(super) fn get(&self, visit: usize) -> (&[u32], u32) {
        let visit = &self.visits[visit..];
        (&visit[..self.num_rows], visit[self.num_rows])
    }

    /// Remembers the visits from the next one on, if there is room for them. `traces` are the active ones.
    #[inline(always)]
    pub(super) fn remember(&mut self, factor: f64, cutoff: f64, traces: &[f64]) {
        if self.num_rows > 0 && factor.to_bits() != self.factor.to_bits() {
            self.begin(factor, cutoff, traces);
        }
    }

    #[cold]
    fn begin(&mut self, factor: f64, cutoff: f64, traces: &[f64]) {
        self.factor = factor;
        let size = self.num_rows + 1;
        let longest = if self.num_rows > MAX_ROWS { 0 } else { self.visits.capacity().min(CAPACITY) / size };
        let decayed = std::iter::successors(Some(factor), |trace| Some(trace * factor));
        let lifetime = decayed.take(longest).position(|trace| trace.abs() <= cutoff);
        // Then no trace lasts longer than one of 1: the product with a smaller magnitude is not greater after rounding either.
        let none_larger = traces.iter().all(|trace| trace.abs() <= 1.0);
        if let Some(lifetime) = lifetime.filter(|_| none_larger) {
            self.lifetime = lifetime + 1;
            self.visits.resize(self.lifetime * size, 0);
            (self.next, self.steps) = (0, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The visits that the decays of some steps return, each step with one row that is its number.
    fn oldest(visits: &mut RecentVisits, steps: std::ops::Range<u32>) -> Vec<Option<(Vec<u32>, u32)>> {
        let step = |step| {
            visits.visit(&[step], 7);
            let oldest =
                visits.end_step(0.5).map(|visit| visits.get(visit)).map(|(rows, action)| (rows.to_vec(), action));
            visits.remember(0.5, 0.2, &[1.0]);
            oldest
        };
        steps.map(step).collect()
    }

    #[test]
    fn the_oldest_visit_follows_once_all_are_remembered() {
        let mut visits = RecentVisits::new(0.2).expect("a few visits");
        // A trace lasts 3 steps, and the first visit is not remembered.
        assert_eq!(oldest(&mut visits, 0..4), [None, None, None, None]);
        assert_eq!(oldest(&mut visits, 4..7), [2, 3, 4].map(|step| Some((vec![step], 7))));
        visits.invalidate();
        assert_eq!(oldest(&mut visits, 7..9), [None, None]);
        visits.clear();
        assert_eq!(oldest(&mut visits, 9..12)[2], Some((vec![9], 7)));
    }

    #[test]
    fn visits_for_which_there_is_no_room_are_not_remembered() {
        let remembers = |rows: usize, factor: f64, cutoff: f64, trace: f64| {
            let mut visits = RecentVisits::new(cutoff).expect("a few visits");
            visits.visit(&vec![0; rows], 0);
            visits.end_step(factor);
            visits.remember(factor, cutoff, &[trace]);
            !visits.visits.is_empty()
        };
        assert!(remembers(8, 0.984, 1e-3, 1.0) && !remembers(8, 0.985, 1e-3, 1.0));
        assert!(remembers(64, 0.5, 1e-3, 1.0) && !remembers(65, 0.5, 1e-3, 1.0));
        assert!(remembers(1, 1.0, 1.0, 1.0) && !remembers(1, 1.0, 0.5, 1.0) && !remembers(1, f64::NAN, 0.5, 1.0));
        assert!(!remembers(1, 0.5, 0.2, 1.5) && !remembers(1, 0.0, 0.0, 1.0));
    }
}
