//! The weights whose traces are not zero, stored side by side so that learning is a pass over contiguous memory.

use std::hint::select_unpredictable;

use super::aligned_vec::{AlignedVec, MAX_PADDING, padding};
use super::trace_changes::select;
use super::trace_pass::BLOCK;
use crate::StopFlag;
use crate::memory::{AllocationError, from_fn, reserve, with_capacity};
use crate::q_table::QTable;
use crate::simd::SimdLevel;

/// The eligible weights: those whose traces are not zero, and some whose traces have become zero. Each has a place.
/// While the run learns, their values are stored at these places, after the rows of the table; see
/// [`QTable::values_at`].
///
/// If the values stayed in the table, each at the index of its weight, a pass would take 2.7 (64 traces) to 7.6 times
/// (256 traces) as long, measured with AVX2 on an Intel Xeon. A run of Sarsa(λ) with 8 tilings has several hundred
/// traces.
#[derive(Clone, Debug)]
pub(super) struct EligibleWeights {
    /// The number of places in use. The first places are used.
    pub(super) count: usize,
    /// The trace at each place, 0 at unused places.
    pub(super) traces: AlignedVec,
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
    moved: bool,
}

impl EligibleWeights {
    /// No eligible weights among `weights` weights, with room for all of them.
    pub(super) fn new(weights: usize, cutoff: f64, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
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
            traces: AlignedVec::with_capacity(places)?,
            smallest: f64::INFINITY,
            cutoff,
            remove_zeros_at: 0,
            level: SimdLevel::detect().without_avx512(),
            long_pass_level: SimdLevel::detect(),
            weights: with_capacity(places)?,
            base: slots.len(),
            slots,
            moved: false,
        })
    }

    /// Makes room after the rows of the table for the values of all weights.
    pub(super) fn reserve<const N: usize>(&self, table: &mut QTable<N>) -> Result<(), AllocationError> {
        let places = self.slots.len().next_multiple_of(BLOCK);
        let storage = table.storage_mut();
        reserve(storage, (self.slots.len() + MAX_PADDING + places).saturating_sub(storage.len()))
    }

    /// The number of weights whose traces are not zero.
    pub(super) fn num_eligible(&self) -> usize {
        self.traces[..self.count].iter().filter(|&&trace| trace != 0.0).count()
    }

    /// The number of weights, eligible or not.
    pub(super) fn num_weights(&self) -> usize {
        self.slots.len()
    }

    /// The index of the value of each weight, for [`QTable::values_at`].
    pub(super) fn slots(&self) -> &[u32] {
        &self.slots
    }

    /// The place of a weight; `None` if it is not eligible.
    #[inline(always)]
    pub(super) fn place(&self, weight: usize) -> Option<usize> {
        (self.slots[weight] as usize).checked_sub(self.base)
    }

    /// The trace of a weight.
    #[inline(always)]
    pub(super) fn trace(&self, weight: usize) -> f64 {
        let (slot, len) = (self.slots[weight] as usize, self.base);
        // No branch, because it is hard to predict which weights are eligible.
        let eligible = slot >= len;
        let place = select_unpredictable(eligible, slot.wrapping_sub(len), 0);
        select(eligible, self.traces.get(place).copied().unwrap_or(0.0), 0.0)
    }

    /// Makes room for this many more eligible weights.
    #[inline(always)]
    pub(super) fn grow(&mut self, additional: usize, storage: &mut Vec<f64>) {
        let places = self.count + additional;
        // There are as many values as traces, because passes work in whole blocks.
        if places > self.traces.len() || self.base + self.traces.len() > storage.len() {
            self.grow_to(places.next_multiple_of(BLOCK), storage);
        }
    }

    #[cold]
    fn grow_to(&mut self, places: usize, storage: &mut Vec<f64>) {
        let places = places.max(self.traces.len());
        self.traces.resize(places, 0.0);
        self.weights.resize(places, 0);
        storage.resize(self.base + places, 0.0);
    }

    /// Moves the values of the eligible weights to their places.
    #[inline(always)]
    pub(super) fn move_out<const N: usize>(&mut self, table: &mut QTable<N>) {
        if !self.moved {
            self.align(table.storage_mut());
            self.move_all(table.storage_mut(), |weight, place| (weight, place));
            self.moved = true;
        }
    }

    /// Moves the values of the eligible weights back into the table.
    pub(super) fn move_back<const N: usize>(&mut self, table: &mut QTable<N>) {
        if self.moved {
            self.move_all(table.storage_mut(), |weight, place| (place, weight));
            self.moved = false;
        }
    }

    /// Aligns the first place to a cache line. The values must be in the table.
    #[cold]
    fn align(&mut self, storage: &[f64]) {
        let len = self.slots.len();
        self.base = len + padding(storage, len);
        for (place, &weight) in self.weights[..self.count].iter().enumerate() {
            self.slots[weight as usize] = (self.base + place) as u32;
        }
    }

    #[cold]
    fn move_all(&mut self, storage: &mut Vec<f64>, direction: impl Fn(usize, usize) -> (usize, usize)) {
        self.grow(0, storage);
        for (place, &weight) in self.weights[..self.count].iter().enumerate() {
            let (from, to) = direction(weight as usize, self.base + place);
            storage[to] = storage[from];
        }
    }

    /// Gives a weight a trace. The values must be in the table, and the weight must not be eligible.
    pub(super) fn insert(&mut self, weight: u32, trace: f64) {
        let place = self.count;
        if place == self.traces.len() {
            self.traces.resize(place + BLOCK, 0.0);
            self.weights.resize(place + BLOCK, 0);
        }
        self.traces[place] = trace;
        self.weights[place] = weight;
        self.slots[weight as usize] = (self.base + place) as u32;
        self.count += 1;
        self.smallest = self.smallest.min(trace.abs());
    }

    /// Sets the trace of a weight to 0.
    #[inline(always)]
    pub(super) fn remove_weight<const N: usize>(&mut self, table: &mut QTable<N>, weight: usize) {
        if let Some(place) = self.place(weight) {
            self.remove(table.storage_mut(), place);
        }
    }

    /// Moves the value at a place back into the table, and the last eligible weight to that place.
    #[inline(always)]
    pub(super) fn remove(&mut self, storage: &mut [f64], place: usize) {
        let (len, last) = (self.base, self.count - 1);
        let (weight, moving) = (self.weights[place], self.weights[last]);
        storage[weight as usize] = storage[len + place];
        storage[len + place] = storage[len + last];
        self.traces[place] = self.traces[last];
        self.traces[last] = 0.0;
        self.weights[place] = moving;
        self.slots[moving as usize] = (len + place) as u32;
        // The order matters, because the two weights can be the same.
        self.slots[weight as usize] = weight;
        self.count = last;
    }

    /// Sets all traces to 0.
    pub(super) fn clear<const N: usize>(&mut self, table: &mut QTable<N>) {
        if self.moved {
            // A single pass moves the values back and frees their places.
            let (values, moved) = table.storage_mut().split_at_mut(self.base);
            let slots = &mut self.slots[..];
            let values = &mut values[..slots.len()];
            for (&weight, &value) in self.weights[..self.count].iter().zip(&*moved) {
                values[weight as usize] = value;
                slots[weight as usize] = weight;
            }
            self.empty();
        } else {
            self.discard();
        }
    }

    /// Sets all traces to 0. The values must be in the table.
    pub(super) fn discard(&mut self) {
        for &weight in &self.weights[..self.count] {
            self.slots[weight as usize] = weight;
        }
        self.empty();
    }

    /// Frees all places.
    fn empty(&mut self) {
        self.traces[..self.count].fill(0.0);
        self.count = 0;
        self.moved = false;
        self.smallest = f64::INFINITY;
        self.remove_zeros_at = 0;
    }
}

/// Equal if the traces are the same, whatever their places. The slots follow from the weights; the other fields only
/// determine when to look for traces at the cutoff.
impl PartialEq for EligibleWeights {
    fn eq(&self, other: &Self) -> bool {
        let parts = |weights: &Self| (weights.num_eligible(), weights.cutoff, weights.moved, weights.num_weights());
        let mut traces = self.weights.iter().zip(&*self.traces).take(self.count);
        parts(self) == parts(other)
            && traces.all(|(&weight, &trace)| trace == 0.0 || other.trace(weight as usize) == trace)
    }
}
