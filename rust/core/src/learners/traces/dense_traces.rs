//! Eligibility traces for features that are all active, a trace for each weight.

use super::trace_vector::persist_trace;
use super::{EligibilityTraces, TraceKind};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::features::ActiveFeatures;
use crate::memory::{AllocationError, reserve};
use crate::numeric::sum_products;
use crate::q_table::{QTable, add_to_column};
use crate::schedules::{LearningRate, StepSize};

/// The trace vector z of weighted features: one trace for each weight of the table, in the same order. A pass goes over
/// the whole table, whose values stay in their rows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DenseTraces {
    /// Empty before the first step.
    z: Vec<f64>,
    /// Traces whose magnitudes fall to this value become 0.
    cutoff: f64,
}

impl DenseTraces {
    /// Traces of 0, which take no memory before the first step.
    pub(super) fn new(cutoff: f64) -> Self {
        Self { z: Vec::new(), cutoff }
    }

    /// Makes room for the traces of a table.
    pub(super) fn reserve(&mut self, table: &QTable) -> Result<(), AllocationError> {
        let missing = table.values().len() - self.z.len();
        reserve(&mut self.z, missing)
    }

    /// The trace of a weight.
    #[inline]
    pub(super) fn get(&self, weight_index: usize) -> f64 {
        self.z.get(weight_index).copied().unwrap_or(0.0)
    }

    /// The number of traces.
    #[inline]
    pub(super) fn pass_len(&self) -> usize {
        self.z.len()
    }

    /// The traces that are not 0 in the order of their weights, as other traces are saved.
    pub(super) fn persist(&mut self, weights: usize, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let mut count = self.z.iter().filter(|&&trace| trace != 0.0).count();
        checkpoint.index(&mut count, weights + 1, "number of traces")?;
        if !checkpoint.is_restoring() {
            for (weight, &trace) in (0..).zip(&self.z).filter(|(_, trace)| **trace != 0.0) {
                persist_trace(checkpoint, weights, (weight, trace))?;
            }
            return Ok(());
        }
        let missing = weights.saturating_sub(self.z.len());
        reserve(&mut self.z, missing).map_err(|_| CheckpointError::OutOfMemory)?;
        self.z.clear();
        self.z.resize(weights, 0.0);
        for _ in 0..count {
            let (weight, trace) = persist_trace(checkpoint, weights, (0, 0.0))?;
            let is_new = std::mem::replace(&mut self.z[weight as usize], trace) == 0.0;
            checkpoint.check(is_new, "weight of two traces")?;
        }
        Ok(())
    }

    /// Adds to each weight its step size times `error` times its trace if `APPLIES`, then multiplies the trace by `factor`
    /// if `DECAYS`.
    #[cfg_attr(target_family = "wasm", inline(never))]
    #[cfg_attr(not(target_family = "wasm"), inline(always))]
    fn pass<const APPLIES: bool, const DECAYS: bool>(
        &mut self,
        table: &mut QTable,
        learning_rate: Option<&LearningRate>,
        error: f64,
        factor: f64,
    ) {
        let (num_actions, cutoff) = (table.num_actions(), self.cutoff);
        let (values, z) = (table.values_mut(), self.z.as_mut_slice());
        let Some(steps) = learning_rate.and_then(StepSize::of_rows) else {
            let step = learning_rate.map_or(0.0, |rate| rate.at(0));
            return change::<APPLIES, DECAYS>(values, z, step * error, (factor, cutoff));
        };
        match num_actions {
            2 => change_rows::<2, APPLIES, DECAYS>(values, z, steps, error, (factor, cutoff)),
            3 => change_rows::<3, APPLIES, DECAYS>(values, z, steps, error, (factor, cutoff)),
            4 => change_rows::<4, APPLIES, DECAYS>(values, z, steps, error, (factor, cutoff)),
            _ => {
                let rows = values.chunks_exact_mut(num_actions).zip(z.chunks_exact_mut(num_actions));
                for ((values, z), step) in rows.zip(steps) {
                    change::<APPLIES, DECAYS>(values, z, step * error, (factor, cutoff));
                }
            }
        }
    }
}

/// The pass over rows of `A` weights, each with its step size.
#[inline(always)]
fn change_rows<const A: usize, const APPLIES: bool, const DECAYS: bool>(
    values: &mut [f64],
    z: &mut [f64],
    steps: &[f64],
    error: f64,
    decay: (f64, f64),
) {
    let rows = values.as_chunks_mut::<A>().0.iter_mut().zip(z.as_chunks_mut::<A>().0);
    for ((values, z), step) in rows.zip(steps) {
        change::<APPLIES, DECAYS>(values, z, step * error, decay);
    }
}

/// The pass over weights with the same step size: `step` is α δ.
#[inline(always)]
fn change<const APPLIES: bool, const DECAYS: bool>(
    values: &mut [f64],
    z: &mut [f64],
    step: f64,
    (factor, cutoff): (f64, f64),
) {
    for (value, trace) in values.iter_mut().zip(z) {
        if APPLIES {
            // The value of a trace of 0 does not change. Adding -0 changes no number, and needs no branch.
            *value += if *trace == 0.0 { -0.0 } else { step * *trace };
        }
        if DECAYS {
            let decayed = *trace * factor;
            *trace = if decayed.abs() <= cutoff { 0.0 } else { decayed };
        }
    }
}

impl EligibilityTraces for DenseTraces {
    #[inline(always)]
    fn begin_step(&mut self, table: &mut QTable) {
        if self.z.is_empty() {
            self.z.resize(table.values().len(), 0.0);
        }
    }

    /// z ← z + x. Returns Q(S, A).
    ///
    /// # Panics
    /// For replacing traces, which set the traces of the active features to 1: all features are active, in every state.
    #[inline(always)]
    fn visit<R: ActiveFeatures>(&mut self, kind: TraceKind, table: &mut QTable, state: R, action: usize) -> f64 {
        assert!(kind == TraceKind::Accumulating, "replacing traces need binary features");
        add_to_column(&mut self.z, table.num_actions(), action, state.values().iter().copied());
        table.value(&state, action)
    }

    #[inline(always)]
    fn action_values<'a, R: ActiveFeatures>(&self, table: &'a mut QTable, state: R) -> &'a [f64] {
        table.action_values(&state)
    }

    #[inline(always)]
    fn value<R: ActiveFeatures>(&self, table: &QTable, state: &R, action: usize) -> f64 {
        table.value(state, action)
    }

    #[inline(always)]
    fn overlap<R: ActiveFeatures>(
        &self,
        table: &QTable,
        learning_rate: &LearningRate,
        (state, action): (&R, usize),
        decay: f64,
    ) -> f64 {
        let (x, num_actions) = (state.values(), table.num_actions());
        let trace = |row: usize| self.z[row * num_actions + action];
        let [sum] = match learning_rate.of_rows() {
            Some(steps) => sum_products(x, |row| [steps[row] * trace(row)]),
            None => sum_products(x, |row| [learning_rate.at(0) * trace(row)]),
        };
        decay * sum
    }

    #[inline(always)]
    fn add<R: ActiveFeatures>(&mut self, table: &mut QTable, (state, action): (&R, usize), increment: f64) {
        let numbers = state.values().iter().map(|x| increment * x);
        add_to_column(&mut self.z, table.num_actions(), action, numbers);
    }

    #[inline(always)]
    fn apply_td_error(&mut self, table: &mut QTable, learning_rate: &LearningRate, error: f64) {
        self.pass::<true, false>(table, Some(learning_rate), error, 1.0);
    }

    #[inline(always)]
    fn decay(&mut self, table: &mut QTable, factor: f64) {
        self.pass::<false, true>(table, None, 0.0, factor);
    }

    #[inline(always)]
    fn apply_td_error_and_decay(&mut self, table: &mut QTable, learning_rate: &LearningRate, error: f64, factor: f64) {
        self.pass::<true, true>(table, Some(learning_rate), error, factor);
    }

    #[inline(always)]
    fn subtract<R: ActiveFeatures>(
        &self,
        table: &mut QTable,
        learning_rate: &LearningRate,
        (state, action): (&R, usize),
        change: f64,
    ) {
        table.add_features(state.values(), action, -change, learning_rate);
    }

    #[inline(always)]
    fn clear(&mut self, _table: &mut QTable) {
        self.z.fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::test_support::features;
    use crate::schedules::Schedule;

    fn table() -> QTable {
        QTable::new(vec![1.0, -0.0, 3.0, 4.0], 2)
    }

    #[test]
    fn a_visit_adds_the_features_to_the_traces_of_its_action() {
        let (mut table, mut traces) = (table(), DenseTraces::new(0.0));
        traces.begin_step(&mut table);
        // 1 · 1 + 3 · 0.5
        assert_eq!(traces.visit(TraceKind::Accumulating, &mut table, features(), 0), 2.5);
        traces.add(&mut table, (&features(), 0), 3.0);
        assert_eq!(traces.z, [4.0, 0.0, 2.0, 0.0]);
    }

    #[test]
    fn each_weight_moves_by_its_step_size_times_the_error_times_its_trace() {
        let scaled = LearningRate::scaled_by_row(Schedule::constant(0.5), vec![1.0, 2.0]);
        let shared = LearningRate::scheduled(Schedule::constant(0.5), 1);
        for (rate, steps) in [(&scaled, [0.5, 0.25]), (&shared, [0.5, 0.5])] {
            let (mut table, mut traces) = (table(), DenseTraces::new(0.3));
            traces.begin_step(&mut table);
            traces.visit(TraceKind::Accumulating, &mut table, features(), 0);
            let overlap = traces.overlap(&table, rate, (&features(), 0), 0.5);
            assert_eq!(overlap, 0.5 * (steps[0] + steps[1] * 0.5 * 0.5));
            // An infinite error does not change a weight without a trace, not even a -0.
            traces.apply_td_error_and_decay(&mut table, rate, 2.0, 0.5);
            let values = [1.0 + steps[0] * 2.0, -0.0, 3.0 + steps[1] * 2.0 * 0.5, 4.0];
            assert_eq!(table.values(), values);
            assert!(table.values()[1].is_sign_negative());
            // 0.5 · 0.5 falls to the cutoff.
            assert_eq!(traces.z, [0.5, 0.0, 0.0, 0.0]);
            assert_eq!(traces.get(0), 0.5);
            traces.apply_td_error(&mut table, rate, f64::INFINITY);
            assert_eq!(table.values()[1..], values[1..]);
            traces.clear(&mut table);
            assert_eq!(traces.z, [0.0; 4]);
        }
    }

    #[test]
    #[should_panic(expected = "replacing traces need binary features")]
    fn replacing_traces_have_no_meaning() {
        let (mut table, mut traces) = (table(), DenseTraces::new(0.0));
        traces.begin_step(&mut table);
        traces.visit(TraceKind::Replacing, &mut table, features(), 0);
    }
}
