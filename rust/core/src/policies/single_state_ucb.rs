//! Upper-confidence-bound action selection for a bandit: one state.

use std::hint::select_unpredictable;
use std::sync::LazyLock;

use super::{Policy, Ucb};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::random::Rng;

/// √(ln t) for the first whole numbers, which all runs need.
static ROOTS: LazyLock<[f64; 4096]> = LazyLock::new(|| std::array::from_fn(|time| root_of_log(time as u64)));

/// √(ln t)
fn root_of_log(time: u64) -> f64 {
    (time as f64).ln().sqrt()
}

/// More than the error of two approximate bounds, each less than 16 roundings, relative to the largest magnitude.
const ERROR: f64 = 1e-13;

/// Upper-confidence-bound action selection for a bandit. It draws and chooses as [`Ucb`] does.
///
/// The bounds Q(a) + c √(ln t / N(a)) are approximated by Q(a) + (c / √N(a)) √(ln t), in which only one factor changes with
/// t, and another one for the action that was chosen. An action whose approximate bound is larger than all others by more
/// than the error of both has the largest bound; if there is none, the bounds are computed.
#[derive(Clone, Debug, PartialEq)]
pub struct SingleStateUcb {
    ucb: Ucb,
    /// c / √N(a), infinite for an action that was never chosen, and c / √(N(a) + 1), computed in advance: a choice would have
    /// to wait for the root and the division.
    scales: Vec<[f64; 2]>,
    /// A buffer for the approximate bounds.
    bounds: Vec<f64>,
    /// No value is farther from 0; NaN if this is unknown, and the scales with it; negative if there is no such number,
    /// because values have overflowed or soon will. All bounds are then computed.
    magnitude: f64,
    /// What the approximate bounds of two actions have to differ by, as long as the largest one is at most `magnitude`.
    margin: f64,
    /// t: 1 + the number of choices.
    time: u64,
    /// The action chosen last: the only one whose value and count have changed since.
    last: usize,
}

impl SingleStateUcb {
    /// From the policy of a table with one row that has not chosen yet.
    pub fn new(ucb: Ucb) -> Self {
        let (scales, bounds) = (Vec::new(), Vec::new());
        Self { ucb, scales, bounds, magnitude: f64::NAN, margin: 0.0, time: 1, last: 0 }
    }

    /// Computes the scales, and finds a magnitude that will last.
    #[cold]
    fn measure(&mut self, values: &[f64]) {
        let magnitudes = values.iter().map(|value| if value.is_nan() { f64::INFINITY } else { value.abs() });
        let magnitude = 2.0 * magnitudes.fold(0.0, f64::max);
        self.set_magnitude(if magnitude.is_finite() { magnitude } else { -1.0 });
        self.bounds.resize(values.len(), 0.0);
        self.scales.clear();
        self.scales.extend((0..values.len()).map(|action| [0, 1].map(|more| self.ucb.scale_at(action, more))));
    }

    /// The parts of a bound, a value and what is added to it, are at most `magnitude` and twice of it. What is too small for
    /// a relative error is below the smallest normal number.
    fn set_magnitude(&mut self, magnitude: f64) {
        self.magnitude = magnitude;
        self.margin = 3.0 * ERROR * magnitude + f64::MIN_POSITIVE;
    }

    /// The action whose approximate bound is larger than all others by more than the error.
    #[expect(clippy::inline_always, reason = "where the number of actions is known, the loops are unrolled")]
    #[inline(always)]
    fn certain_best(&mut self, values: &[f64]) -> Option<usize> {
        let root = match ROOTS.get(self.time as usize) {
            Some(&root) => root,
            None => root_of_log(self.time),
        };
        let (scales, bounds) = (&self.scales[..values.len()], &mut self.bounds[..values.len()]);
        let mut largest = f64::NEG_INFINITY;
        for action in 0..values.len() {
            let bound = values[action] + scales[action][0] * root;
            bounds[action] = bound;
            largest = if bound > largest { bound } else { largest };
        }
        let is_covered = largest.abs() <= self.magnitude;
        if !is_covered {
            let magnitude = 2.0 * largest.abs();
            if magnitude.is_finite() && self.magnitude >= 0.0 {
                self.set_magnitude(magnitude);
            }
            return None;
        }
        let threshold = largest - self.margin;
        // Which action it is changes so often that branches would be mispredicted.
        let (mut best, mut count) = (0, 0);
        for (action, &bound) in bounds.iter().enumerate() {
            let is_candidate = bound >= threshold;
            best = select_unpredictable(is_candidate, action, best);
            count += usize::from(is_candidate);
        }
        (count == 1).then_some(best)
    }
}

impl Policy for SingleStateUcb {
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn choose(&mut self, values: &[f64], rng: &mut impl Rng) -> usize {
        let is_known = values[self.last].abs() <= self.magnitude;
        if !is_known {
            self.measure(values);
        }
        self.last = match self.certain_best(values) {
            Some(action) => {
                self.ucb.count(0, action);
                action
            }
            None => self.ucb.choose(0, values, rng),
        };
        let [scale, next_scale] = &mut self.scales[self.last];
        (*scale, *next_scale) = (*next_scale, self.ucb.scale_at(self.last, 1));
        self.time += 1;
        self.last
    }

    fn expected_value(&mut self, values: &[f64]) -> f64 {
        self.ucb.expected_value(0, values)
    }

    /// It has counted its choice since; nothing that needs probabilities is combined with it.
    fn probability(&mut self, _values: &[f64], _action: usize) -> f64 {
        1.0
    }

    /// The counts are stored. Other values and counts may be restored, so that the next choice measures them.
    fn persist_counts(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.ucb.persist_counts(checkpoint)?;
        (self.time, self.magnitude) = (self.ucb.time(0), f64::NAN);
        Ok(())
    }

    #[inline]
    fn end_episode(&mut self) {}
}
