//! The updates of all eligible weights and the decay of their traces.

use super::Traces;
use super::trace_pass::{BLOCK, LONG_PASS, TracePass};
use crate::q_table::QTable;
use crate::schedules::{LearningRate, StepSize};

impl Traces {
    /// w ← w + α δ z.
    #[inline(always)]
    pub fn apply_td_error(&mut self, table: &mut QTable, learning_rate: &LearningRate, error: f64) {
        match learning_rate.uniform() {
            Some(step_size) => self.pass::<true, false>(table, step_size * error, 1.0),
            None => self.apply_each(table, |weight, trace| learning_rate.at(weight) * error * trace),
        }
    }

    /// Adds to each eligible weight a function of its index and its trace.
    fn apply_each(&mut self, table: &mut QTable, change: impl Fn(usize, f64) -> f64) {
        let values = &mut table.storage_mut()[self.base..];
        let traces = self.weights.iter().zip(&*self.z).take(self.count);
        for (value, (&weight, &trace)) in values.iter_mut().zip(traces) {
            if trace != 0.0 {
                *value += change(weight as usize, trace);
            }
        }
    }

    /// z ← γλ z, where `factor` is γλ; traces whose magnitudes fall to the cutoff become 0.
    #[inline(always)]
    pub fn decay(&mut self, table: &mut QTable, factor: f64) {
        self.bound_magnitudes(factor);
        self.pass::<false, true>(table, 0.0, factor);
        self.remove_zeros(table.storage_mut());
    }

    /// [`apply_td_error`](Self::apply_td_error) and [`decay`](Self::decay) in one pass.
    #[inline(always)]
    pub fn apply_td_error_and_decay(
        &mut self,
        table: &mut QTable,
        learning_rate: &LearningRate,
        error: f64,
        factor: f64,
    ) {
        if let Some(step_size) = learning_rate.uniform() {
            self.bound_magnitudes(factor);
            self.pass::<true, true>(table, step_size * error, factor);
            self.remove_zeros(table.storage_mut());
        } else {
            self.apply_td_error(table, learning_rate, error);
            self.decay(table, factor);
        }
    }

    #[inline(always)]
    fn pass<const APPLIES: bool, const DECAYS: bool>(&mut self, table: &mut QTable, step: f64, factor: f64) {
        let len = self.count.next_multiple_of(BLOCK);
        let values = &mut table.storage_mut()[self.base..][..len];
        let cutoff = (self.smallest == 0.0).then_some(self.cutoff);
        let traces = &mut self.z[..len];
        let level = if len < LONG_PASS { self.level } else { self.long_pass_level };
        level.run(&mut TracePass::<APPLIES, DECAYS> { values, traces, step, factor, cutoff });
    }

    /// Updates the lower bound on the magnitudes of the traces after a decay.
    fn bound_magnitudes(&mut self, factor: f64) {
        let smallest = self.smallest * factor.abs();
        // NaN, the result of ∞ · 0, is not a bound either.
        self.smallest = if smallest > self.cutoff { smallest } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StopFlag;

    fn with_traces(traces: &[f64], cutoff: f64) -> Traces {
        let mut weights = Traces::new(4, cutoff, &StopFlag::new()).expect("a few weights");
        for (weight, &trace) in traces.iter().enumerate() {
            weights.insert(weight as u32, trace);
        }
        weights
    }

    /// The bound after a decay of these traces.
    fn bound(traces: &[f64], factor: f64, cutoff: f64) -> f64 {
        let mut weights = with_traces(traces, cutoff);
        weights.bound_magnitudes(factor);
        weights.smallest
    }

    #[test]
    fn the_bound_is_0_once_a_trace_may_be_0() {
        assert_eq!(bound(&[1.0, -0.5], -0.9, 0.2), 0.45);
        assert_eq!(bound(&[1.0, -0.5], 0.4, 0.2), 0.0);
        assert_eq!(bound(&[], 0.0, 0.2), 0.0);
        assert_eq!(bound(&[1.0, f64::MIN_POSITIVE], f64::MIN_POSITIVE, 0.0), 0.0);
        let mut weights = with_traces(&[0.5], 0.4);
        for factor in [0.5, 1.5, 1.5, 1.5] {
            weights.bound_magnitudes(factor);
            assert_eq!(weights.smallest, 0.0);
        }
    }
}
