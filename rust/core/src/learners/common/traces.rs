//! Eligibility traces, stored sparsely: a step takes time in proportion to the number of active traces, not to the size
//! of the table.

use std::hint::select_unpredictable;

use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::memory::{AllocationError, filled, with_capacity};
use crate::q_table::QTable;
use crate::schedules::{LearningRate, StepSize};

/// How a visit of a state-action pair changes traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceKind {
    /// Adds 1 to the traces of the pair (Sutton & Barto, section 12.7).
    Accumulating,
    /// Sets the traces of the pair to 1 (S. Singh and R. Sutton, 1996).
    Replacing,
    /// Sets the traces of the pair to 1 and those of the other actions in that state to 0 (the same paper).
    Clearing,
}

/// A trace that is not zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ActiveTrace {
    weight_index: u32,
    trace: f64,
}

/// The number of traces updated per iteration of the blocked loop.
const BLOCK: usize = 16;

/// The trace vector z, with one trace per weight. A trace whose magnitude falls to the cutoff becomes 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Traces {
    /// The first `count` elements are in use.
    active: Vec<ActiveTrace>,
    count: usize,
    /// For each weight one more than the index of its trace in `active`, or 0 if it has no active trace.
    positions: Vec<u32>,
    cutoff: f64,
}

impl Traces {
    /// Traces of `weights` weights, all 0. There is room for all of them, so that a step cannot run out of memory.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(weights: usize, cutoff: f64, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        let (active, positions) = (with_capacity(weights)?, filled(&0, weights, stop)?);
        Ok(Self { active, count: 0, positions, cutoff })
    }

    /// The number of active traces.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether no trace is active.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The trace of a weight.
    #[inline]
    pub fn get(&self, weight_index: usize) -> f64 {
        match self.positions[weight_index] {
            0 => 0.0,
            position => self.active[position as usize - 1].trace,
        }
    }

    /// Replaces the trace of a weight by a function of it. The trace becomes active.
    #[inline]
    pub fn update(&mut self, weight_index: usize, change: impl FnOnce(f64) -> f64) {
        if self.count == self.active.len() {
            self.active.push(ActiveTrace::default());
        }
        // No branch, because whether a trace is active is hard to predict.
        let position = (self.positions[weight_index] as usize).checked_sub(1);
        let new = position.is_none();
        let position = position.unwrap_or(self.count);
        let trace = self.active[position].trace;
        let trace = change(select_unpredictable(new, 0.0, trace));
        self.active[position] = ActiveTrace { weight_index: weight_index as u32, trace };
        self.positions[weight_index] = position as u32 + 1;
        self.count += usize::from(new);
    }

    /// Changes the traces for a visit of a state-action pair.
    #[inline]
    pub fn visit<const N: usize>(&mut self, kind: TraceKind, table: &QTable<N>, rows: &[u32], action: usize) {
        for &row in rows {
            let weight_index = table.weight_index(row, action);
            match kind {
                TraceKind::Accumulating => self.update(weight_index, |trace| trace + 1.0),
                TraceKind::Replacing => self.update(weight_index, |_| 1.0),
                TraceKind::Clearing => {
                    self.update(weight_index, |_| 1.0);
                    for other in (0..table.num_actions()).filter(|&other| other != action) {
                        self.remove_weight(table.weight_index(row, other));
                    }
                }
            }
        }
    }

    /// Sets the trace of a weight to 0.
    fn remove_weight(&mut self, weight_index: usize) {
        if let Some(position) = (self.positions[weight_index] as usize).checked_sub(1) {
            self.remove(position);
        }
    }

    /// Removes an active trace and moves the last one to its position.
    #[cold]
    fn remove(&mut self, position: usize) {
        self.positions[self.active[position].weight_index as usize] = 0;
        self.count -= 1;
        if position < self.count {
            self.active[position] = self.active[self.count];
            self.positions[self.active[position].weight_index as usize] = position as u32 + 1;
        }
    }

    /// w ← w + α δ z.
    #[inline]
    pub fn apply_td_error<const N: usize>(&self, table: &mut QTable<N>, learning_rate: &LearningRate, error: f64) {
        if let Some(step_size) = learning_rate.uniform() {
            let step = step_size * error;
            for &ActiveTrace { weight_index, trace } in &self.active[..self.count] {
                *table.weight_mut(weight_index as usize) += step * trace;
            }
        } else {
            for &ActiveTrace { weight_index, trace } in &self.active[..self.count] {
                *table.weight_mut(weight_index as usize) += learning_rate.at(weight_index as usize) * error * trace;
            }
        }
    }

    /// z ← γλ z, where `factor` is γλ.
    #[inline]
    pub fn decay(&mut self, factor: f64) {
        let (cutoff, mut any_below) = (self.cutoff, false);
        for ActiveTrace { trace, .. } in &mut self.active[..self.count] {
            *trace *= factor;
            any_below |= trace.abs() <= cutoff;
        }
        if any_below {
            self.prune();
        }
    }

    /// w ← w + α δ z and z ← γλ z in one pass.
    #[inline]
    pub fn apply_td_error_and_decay<const N: usize>(
        &mut self,
        table: &mut QTable<N>,
        learning_rate: &LearningRate,
        error: f64,
        factor: f64,
    ) {
        let Some(step_size) = learning_rate.uniform() else {
            self.apply_td_error(table, learning_rate, error);
            self.decay(factor);
            return;
        };
        let (step, cutoff, mut any_below) = (step_size * error, self.cutoff, false);
        let values = table.values_mut();
        let mut update = |traces: &mut [ActiveTrace]| {
            for ActiveTrace { weight_index, trace } in traces {
                values[*weight_index as usize] += step * *trace;
                *trace *= factor;
                any_below |= trace.abs() <= cutoff;
            }
        };
        // The number of traces is hard to predict, the number of blocks is not. Taking the remainder first reveals the end
        // of the loop early, so that the processor can start on the next step.
        let (remainder, blocks) = self.active[..self.count].as_rchunks_mut::<BLOCK>();
        update(remainder);
        for block in blocks {
            update(block);
        }
        if any_below {
            self.prune();
        }
    }

    /// Removes the traces at or below the cutoff.
    fn prune(&mut self) {
        let mut position = 0;
        while position < self.count {
            if self.active[position].trace.abs() <= self.cutoff {
                self.remove(position);
            } else {
                position += 1;
            }
        }
    }

    /// z ← 0.
    pub fn clear(&mut self) {
        for trace in &self.active[..self.count] {
            self.positions[trace.weight_index as usize] = 0;
        }
        self.count = 0;
    }
}

/// The active traces in their order, which is that of their updates.
impl Persist for Traces {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let weights = self.positions.len();
        let mut count = self.count;
        checkpoint.index(&mut count, weights + 1, "number of traces")?;
        if checkpoint.is_restoring() {
            self.clear();
        }
        for position in 0..count {
            let mut active = self.active.get(position).copied().unwrap_or_default();
            checkpoint.index_u32(&mut active.weight_index, weights, "weight of a trace")?;
            active.trace.persist(checkpoint)?;
            if checkpoint.is_restoring() {
                if self.positions[active.weight_index as usize] != 0 {
                    return Err(CheckpointError::Invalid("weight of two traces"));
                }
                self.update(active.weight_index as usize, |_| active.trace);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StopFlag;
    use crate::schedules::Schedule;

    /// The traces of two actions after these visits, with γλ = 0.5.
    fn traces_after(kind: TraceKind, actions: &[usize]) -> [f64; 2] {
        let table = QTable::<2>::new(vec![0.0; 2], 2);
        let mut traces = Traces::new(2, 0.0, &StopFlag::new()).expect("a few weights");
        for &action in actions {
            traces.decay(0.5);
            traces.visit(kind, &table, &[0], action);
        }
        [traces.get(0), traces.get(1)]
    }

    #[test]
    fn each_kind_changes_the_traces_as_defined() {
        assert_eq!(traces_after(TraceKind::Accumulating, &[0, 1, 1]), [0.25, 1.5]);
        assert_eq!(traces_after(TraceKind::Replacing, &[0, 1, 1]), [0.25, 1.0]);
        assert_eq!(traces_after(TraceKind::Clearing, &[0, 1, 1]), [0.0, 1.0]);
    }

    #[test]
    fn the_combined_pass_equals_two_passes() {
        let mut tables = [QTable::<2>::new(vec![1.0, 2.0, 3.0, 4.0], 2), QTable::new(vec![1.0, 2.0, 3.0, 4.0], 2)];
        let mut traces = Traces::new(4, 0.25, &StopFlag::new()).expect("a few weights");
        (0..4).for_each(|weight_index| traces.update(weight_index, |_| 0.3 * (1 + weight_index) as f64));
        let (learning_rate, mut combined) = (LearningRate::scheduled(Schedule::constant(0.1), 2), traces.clone());
        traces.apply_td_error(&mut tables[0], &learning_rate, -7.0);
        traces.decay(0.5);
        combined.apply_td_error_and_decay(&mut tables[1], &learning_rate, -7.0, 0.5);
        assert_eq!((&tables[0], traces), (&tables[1], combined.clone()));
        assert_eq!(combined.len(), 3);
    }

    #[test]
    fn a_trace_at_the_cutoff_is_removed_and_the_others_stay() {
        let mut traces = Traces::new(4, 0.25, &StopFlag::new()).expect("a few weights");
        for weight_index in 0..4 {
            traces.update(weight_index, |_| if weight_index % 2 == 0 { 0.5 } else { 1.0 });
        }
        traces.decay(0.5);
        assert_eq!(traces.len(), 2);
        assert_eq!([0, 1, 2, 3].map(|weight_index| traces.get(weight_index)), [0.0, 0.5, 0.0, 0.5]);
        traces.clear();
        assert!(traces.is_empty() && traces.get(1) == 0.0);
    }
}
