//! Eligibility traces, stored sparsely: a step takes time in proportion to the number of active traces, not to the size
//! of the table.

use std::hint::select_unpredictable;

use super::aligned_vec::{AlignedVec, MAX_PADDING};
use super::dense_traces::DenseTraces;
use super::trace_changes::select;
use super::trace_pass::BLOCK;
use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::ActiveFeatures;
use crate::memory::{AllocationError, from_fn, reserve, with_capacity};
use crate::q_table::QTable;
use crate::simd::SimdLevel;

/// The effect of a visit to a state-action pair on its traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceKind {
    /// Adds 1 to the traces of the pair (Sutton & Barto, section 12.7).
    Accumulating,
    /// Sets the traces of the pair to 1 (S. Singh and R. Sutton, 1996).
    Replacing,
    /// Sets the traces of the pair to 1 and those of the other actions in that state to 0 (the same paper).
    Clearing,
}

/// The options of an algorithm with eligibility traces of a chosen kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceOptions {
    /// The effect of a visit on the traces.
    pub kind: TraceKind,
    /// The trace decay λ.
    pub decay: f64,
    /// Traces at or below this are dropped.
    pub cutoff: f64,
}

/// Replacing traces with λ = 0.9, none of which is dropped.
impl Default for TraceOptions {
    fn default() -> Self {
        Self { kind: TraceKind::Replacing, decay: 0.9, cutoff: 0.0 }
    }
}

/// The trace vector z, with one trace per weight. A trace whose magnitude falls to the cutoff becomes 0.
///
/// The weights whose traces are active (not 0), and some whose traces have become 0, are eligible: each has a place, and
/// the places lie side by side, so that learning is a pass over contiguous memory. From [`begin_step`](Self::begin_step)
/// until [`complete_table`](Self::complete_table), the values of the eligible weights are at their places, after the rows
/// of the table, and are read with [`action_values`](Self::action_values).
///
/// If the values stayed in the table, each at the index of its weight, a pass would take 2.7 (64 traces) to 7.6 times
/// (256 traces) as long, measured with AVX2 on an Intel Xeon. A run of Sarsa(λ) with 8 tilings has several hundred
/// traces.
#[derive(Clone, Debug)]
pub struct Traces {
    /// The number of places in use. The first places are used.
    pub(super) count: usize,
    /// The trace z at each place, 0 at unused places.
    pub(super) z: AlignedVec,
    /// A lower bound on the magnitudes of the traces; 0 if a trace may be 0.
    pub(super) smallest: f64,
    /// Traces whose magnitudes fall to this value become 0.
    pub(super) cutoff: f64,
    /// The index of the weight at each place in use.
    pub(super) weights: Vec<u32>,
    /// Weights with traces of 0 are removed once this many places are in use.
    pub(super) remove_zeros_at: usize,
    /// The instructions for short passes over traces.
    pub(super) level: SimdLevel,
    /// The instructions for long passes.
    pub(super) long_pass_level: SimdLevel,
    /// For each weight the index of its value in the storage of the table: the index of the weight, or `base` plus its
    /// place.
    pub(super) slots: Vec<u32>,
    /// The index of the value at the first place, which is at the start of a cache line.
    pub(super) base: usize,
    /// Whether the values of the eligible weights are at their places.
    pub(super) moved: bool,
    /// The traces of weighted features, which are used instead of all fields above.
    pub(super) dense: DenseTraces,
}

impl Traces {
    /// Traces of `weights` weights, all 0. There is room for all of them, so a step cannot run out of memory.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(weights: usize, cutoff: f64, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        // The indices of a table and as many places must fit into 32 bits.
        if weights > u32::MAX as usize / 2 - BLOCK - MAX_PADDING {
            return Err(AllocationError::OutOfMemory { bytes: weights.saturating_mul(32) });
        }
        let places = weights.next_multiple_of(BLOCK);
        let mut next = 0;
        let slots = from_fn(weights, stop, || {
            next += 1;
            next - 1
        })?;
        Ok(Self {
            count: 0,
            z: AlignedVec::with_capacity(places)?,
            smallest: f64::INFINITY,
            cutoff,
            remove_zeros_at: 0,
            level: SimdLevel::detect().without_avx512(),
            long_pass_level: SimdLevel::detect(),
            weights: with_capacity(places)?,
            base: slots.len(),
            slots,
            moved: false,
            dense: DenseTraces::new(cutoff),
        })
    }

    /// Sets the instructions of passes over these traces. The default is the best of the machine.
    #[cfg(test)]
    pub(super) fn set_level(&mut self, level: SimdLevel) {
        (self.level, self.long_pass_level) = (level, level);
    }

    /// Makes room in the table for the values of the weights with traces.
    ///
    /// # Errors
    /// `OutOfMemory`.
    pub fn reserve(&self, table: &mut QTable) -> Result<(), AllocationError> {
        let places = self.slots.len().next_multiple_of(BLOCK);
        let storage = table.storage_mut();
        reserve(storage, (self.slots.len() + MAX_PADDING + places).saturating_sub(storage.len()))
    }

    /// The number of traces that a pass goes over: the active ones, and some that have become 0.
    pub fn pass_len(&self) -> usize {
        self.count
    }

    /// The number of active traces.
    pub(super) fn num_active(&self) -> usize {
        self.z[..self.count].iter().filter(|&&trace| trace != 0.0).count()
    }

    /// Whether no trace is active.
    #[cfg(test)]
    pub(in crate::learners) fn is_empty(&self) -> bool {
        self.num_active() == 0
    }

    /// The trace of a weight.
    #[inline(always)]
    pub fn get(&self, weight_index: usize) -> f64 {
        let (slot, len) = (self.slots[weight_index] as usize, self.base);
        // No branch, because it is hard to predict which weights are eligible.
        let eligible = slot >= len;
        let place = select_unpredictable(eligible, slot.wrapping_sub(len), 0);
        select(eligible, self.z.get(place).copied().unwrap_or(0.0), 0.0)
    }

    /// The sum of the traces of a state-action pair, from left to right.
    #[inline(always)]
    pub fn sum(&self, table: &QTable, rows: &[u32], action: usize) -> f64 {
        rows.iter().fold(0.0, |sum, &row| sum + self.get(table.weight_index(row, action)))
    }

    /// Changes the traces for a visit to a state-action pair. Returns Q(S, A).
    #[inline(always)]
    pub fn visit(&mut self, kind: TraceKind, table: &mut QTable, rows: impl ActiveFeatures, action: usize) -> f64 {
        if kind == TraceKind::Accumulating {
            return self.update(table, rows, action, |trace| trace + 1.0);
        }
        let value = self.replace(table, &rows, action);
        if kind == TraceKind::Clearing {
            for &row in rows.as_ref() {
                for other in (0..table.num_actions()).filter(|&other| other != action) {
                    self.remove_weight(table, table.weight_index(row, other));
                }
            }
        }
        value
    }

    /// The action values of a state, as [`QTable::action_values`].
    #[inline(always)]
    pub fn action_values<'a>(&self, table: &'a mut QTable, rows: impl ActiveFeatures) -> &'a [f64] {
        table.values_at(&self.slots, &rows)
    }

    /// Q(S, A), as [`QTable::value`].
    #[inline(always)]
    pub fn value(&self, table: &QTable, rows: &[u32], action: usize) -> f64 {
        table.value_at(&self.slots, rows, action)
    }

    /// Subtracts a number from the weights of a state-action pair, whose traces must be active.
    #[inline(always)]
    pub fn subtract(&self, table: &mut QTable, rows: &[u32], action: usize, number: f64) {
        for &row in rows {
            let slot = self.slots[table.weight_index(row, action)];
            table.storage_mut()[slot as usize] -= number;
        }
    }
}

/// Saves the active traces in the order of their weights, because their places depend on the history of the run.
impl Persist for Traces {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let weights = self.slots.len();
        let mut count = self.num_active();
        checkpoint.index(&mut count, weights + 1, "number of traces")?;
        if !checkpoint.is_restoring() {
            for weight in 0..weights {
                let trace = self.get(weight);
                if trace != 0.0 {
                    persist_trace(checkpoint, weights, (weight as u32, trace))?;
                }
            }
            return Ok(());
        }
        self.discard();
        for _ in 0..count {
            let (weight, trace) = persist_trace(checkpoint, weights, (0, 0.0))?;
            if self.place(weight as usize).is_some() {
                return Err(CheckpointError::Invalid("weight of two traces"));
            }
            self.insert(weight, trace);
        }
        Ok(())
    }
}

/// Saves or restores the index of a weight and its trace.
pub(super) fn persist_trace(
    checkpoint: &mut Checkpoint<'_>,
    weights: usize,
    (mut weight, mut trace): (u32, f64),
) -> Result<(u32, f64), CheckpointError> {
    checkpoint.index_u32(&mut weight, weights, "weight of a trace")?;
    trace.persist(checkpoint)?;
    Ok((weight, trace))
}
