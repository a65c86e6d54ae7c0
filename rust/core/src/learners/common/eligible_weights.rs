//! The weights whose traces are not zero, side by side: learning is then a pass over contiguous memory.

use std::hint::select_unpredictable;

use super::trace_passes::{ApplyAndDecayTraces, ApplyTraces, BLOCK, DecayTraces, InstructionSet};
use crate::StopFlag;
use crate::memory::{AllocationError, from_fn, reserve, with_capacity};
use crate::q_table::QTable;

/// The trace of a place in use by no weight. No comparison finds it below a cutoff.
const UNUSED: f64 = f64::NAN;

/// The eligible weights, those whose traces are not zero. Each has a place. While the run learns, their values have moved
/// out of the table, to the same places behind it; see [`QTable::values_at`].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EligibleWeights {
    /// The number of places in use. They are the first ones.
    count: usize,
    /// The trace at each place.
    traces: Vec<f64>,
    /// The index of the weight at each place in use.
    weights: Vec<u32>,
    /// For each block of places, whether a trace has fallen to the cutoff.
    fallen: Vec<bool>,
    /// For each weight the index of its value in the storage of the table: its own index, or that of its place, which is
    /// the number of weights more.
    slots: Vec<u32>,
    /// Whether the values of the eligible weights are at their places.
    moved: bool,
    instructions: InstructionSet,
}

impl EligibleWeights {
    /// No eligible weights among so many, with room for all.
    pub(super) fn new(weights: usize, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        // A table and as many places have indices of 32 bits.
        if weights > u32::MAX as usize / 2 - BLOCK {
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
            traces: with_capacity(places)?,
            weights: with_capacity(places)?,
            fallen: with_capacity(places / BLOCK)?,
            slots,
            moved: false,
            instructions: InstructionSet::detect(),
        })
    }

    /// Makes room behind the table for the values of all weights.
    pub(super) fn reserve<const N: usize>(&self, table: &mut QTable<N>) -> Result<(), AllocationError> {
        let places = self.slots.len().next_multiple_of(BLOCK);
        let storage = table.storage_mut();
        reserve(storage, (self.slots.len() + places).saturating_sub(storage.len()))
    }

    /// The number of eligible weights.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// The number of weights, eligible or not.
    pub(super) fn num_weights(&self) -> usize {
        self.slots.len()
    }

    /// Where the value of each weight is, for [`QTable::values_at`].
    pub(super) fn slots(&self) -> &[u32] {
        &self.slots
    }

    /// The eligible weight at a place, and its trace.
    pub(super) fn at(&self, place: usize) -> Option<(u32, f64)> {
        (place < self.count).then(|| (self.weights[place], self.traces[place]))
    }

    /// The place of a weight; `None` if it is not eligible.
    #[inline]
    pub(super) fn place(&self, weight: usize) -> Option<usize> {
        (self.slots[weight] as usize).checked_sub(self.slots.len())
    }

    /// The trace of a weight.
    #[inline]
    pub(super) fn trace(&self, weight: usize) -> f64 {
        let (slot, len) = (self.slots[weight] as usize, self.slots.len());
        // No branch, because whether a weight is eligible is hard to predict.
        let eligible = slot >= len;
        let place = select_unpredictable(eligible, slot.wrapping_sub(len), 0);
        select(eligible, self.traces.get(place).copied().unwrap_or(0.0), 0.0)
    }

    /// Makes room for so many more eligible weights.
    #[inline]
    fn grow(&mut self, additional: usize, storage: &mut Vec<f64>) {
        let places = self.count + additional;
        if places > self.traces.len() || self.slots.len() + places > storage.len() {
            self.grow_to(places.next_multiple_of(BLOCK), storage);
        }
    }

    #[cold]
    fn grow_to(&mut self, places: usize, storage: &mut Vec<f64>) {
        let places = places.max(self.traces.len());
        self.traces.resize(places, UNUSED);
        self.weights.resize(places, 0);
        self.fallen.resize(places / BLOCK, false);
        storage.resize(self.slots.len() + places, 0.0);
    }

    /// Moves the values of the eligible weights to their places.
    #[inline]
    pub(super) fn move_out<const N: usize>(&mut self, table: &mut QTable<N>) {
        if !self.moved {
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

    #[cold]
    fn move_all(&mut self, storage: &mut Vec<f64>, direction: impl Fn(usize, usize) -> (usize, usize)) {
        self.grow(0, storage);
        for (place, &weight) in self.weights[..self.count].iter().enumerate() {
            let (from, to) = direction(weight as usize, self.slots.len() + place);
            storage[to] = storage[from];
        }
    }

    /// Replaces the traces of some weights, one after the other, by a function of the trace. Returns the sum of the values
    /// from left to right.
    #[inline]
    pub(super) fn update<const N: usize>(
        &mut self,
        table: &mut QTable<N>,
        weights: impl ExactSizeIterator<Item = usize>,
        change: impl Fn(f64) -> f64,
    ) -> f64 {
        self.grow(weights.len(), table.storage_mut());
        // Local variables: behind `self` and `table` each weight would load them again.
        let len = self.slots.len();
        let slots = self.slots.as_mut_slice();
        let traces = self.traces.as_mut_slice();
        let places = &mut self.weights[..traces.len()];
        let (storage, mut count) = (table.storage_mut().as_mut_slice(), self.count);
        let mut sum = None;
        for weight in weights {
            let slot = slots[weight] as usize;
            let value = storage[slot];
            // No branch, because whether a weight is eligible is hard to predict.
            let new = slot < len;
            let place = select_unpredictable(new, count, slot.wrapping_sub(len));
            traces[place] = change(select(new, 0.0, traces[place]));
            places[place] = weight as u32;
            storage[len + place] = value;
            slots[weight] = (len + place) as u32;
            count += usize::from(new);
            sum = Some(sum.map_or(value, |sum| sum + value));
        }
        self.count = count;
        sum.unwrap_or(0.0)
    }

    /// Gives a weight a trace, while the values are in the table. The weight must not be eligible.
    pub(super) fn insert(&mut self, weight: u32, trace: f64) {
        let place = self.count;
        if place == self.traces.len() {
            self.traces.resize(place + BLOCK, UNUSED);
            self.weights.resize(place + BLOCK, 0);
            self.fallen.push(false);
        }
        self.traces[place] = trace;
        self.weights[place] = weight;
        self.slots[weight as usize] = (self.slots.len() + place) as u32;
        self.count += 1;
    }

    /// Sets the trace of a weight to 0.
    #[inline]
    pub(super) fn remove_weight<const N: usize>(&mut self, table: &mut QTable<N>, weight: usize) {
        if let Some(place) = self.place(weight) {
            self.remove(table.storage_mut(), place);
        }
    }

    /// Moves the value at a place back into the table, and the last eligible weight to that place.
    #[inline]
    fn remove(&mut self, storage: &mut [f64], place: usize) {
        let (len, last) = (self.slots.len(), self.count - 1);
        let (weight, moving) = (self.weights[place], self.weights[last]);
        storage[weight as usize] = storage[len + place];
        storage[len + place] = storage[len + last];
        self.traces[place] = self.traces[last];
        self.traces[last] = UNUSED;
        self.weights[place] = moving;
        self.slots[moving as usize] = (len + place) as u32;
        // In this order, because the two can be the same.
        self.slots[weight as usize] = weight;
        self.count = last;
    }

    /// Sets all traces to 0.
    pub(super) fn clear<const N: usize>(&mut self, table: &mut QTable<N>) {
        self.move_back(table);
        self.discard();
    }

    /// Sets all traces to 0, while the values are in the table.
    pub(super) fn discard(&mut self) {
        for &weight in &self.weights[..self.count] {
            self.slots[weight as usize] = weight;
        }
        self.traces[..self.count].fill(UNUSED);
        self.count = 0;
        self.moved = false;
    }

    /// Adds to each eligible weight a step times its trace.
    #[inline]
    pub(super) fn apply<const N: usize>(&mut self, table: &mut QTable<N>, step: f64) {
        let len = self.count.next_multiple_of(BLOCK);
        let values = &mut table.storage_mut()[self.slots.len()..][..len];
        self.instructions.run(ApplyTraces { values, traces: &self.traces[..len], step });
    }

    /// Adds to each eligible weight a function of its index and its trace.
    pub(super) fn apply_each<const N: usize>(&mut self, table: &mut QTable<N>, change: impl Fn(usize, f64) -> f64) {
        let values = &mut table.storage_mut()[self.slots.len()..];
        let traces = self.weights.iter().zip(&self.traces).take(self.count);
        for (value, (&weight, &trace)) in values.iter_mut().zip(traces) {
            *value += change(weight as usize, trace);
        }
    }

    /// Multiplies the traces by a factor; those whose magnitudes fall to the cutoff become 0.
    #[inline]
    pub(super) fn decay<const N: usize>(&mut self, table: &mut QTable<N>, factor: f64, cutoff: f64) {
        let blocks = self.count.div_ceil(BLOCK);
        let (traces, fallen) = (&mut self.traces[..blocks * BLOCK], &mut self.fallen[..blocks]);
        if self.instructions.run(DecayTraces { traces, fallen, factor, cutoff }) {
            self.remove_fallen(table.storage_mut(), cutoff);
        }
    }

    /// [`apply`](Self::apply) and [`decay`](Self::decay) in one pass.
    #[inline]
    pub(super) fn apply_and_decay<const N: usize>(
        &mut self,
        table: &mut QTable<N>,
        step: f64,
        factor: f64,
        cutoff: f64,
    ) {
        let blocks = self.count.div_ceil(BLOCK);
        let values = &mut table.storage_mut()[self.slots.len()..][..blocks * BLOCK];
        let (traces, fallen) = (&mut self.traces[..blocks * BLOCK], &mut self.fallen[..blocks]);
        if self.instructions.run(ApplyAndDecayTraces {
            values,
            step,
            decay: DecayTraces { traces, fallen, factor, cutoff },
        }) {
            self.remove_fallen(table.storage_mut(), cutoff);
        }
    }

    /// Sets to 0 the traces at or below the cutoff, in the blocks where a pass has found some. From the last one on, so that
    /// the weight that takes the place of another one has been looked at.
    fn remove_fallen(&mut self, storage: &mut [f64], cutoff: f64) {
        for block in (0..self.count.div_ceil(BLOCK)).rev() {
            if self.fallen[block] {
                for place in (block * BLOCK..(block + 1) * BLOCK).rev() {
                    if self.traces[place].abs() <= cutoff {
                        self.remove(storage, place);
                    }
                }
            }
        }
    }
}

/// One of two numbers, without a branch. Not every instruction set can select between floats.
#[inline]
fn select(condition: bool, yes: f64, no: f64) -> f64 {
    f64::from_bits(select_unpredictable(condition, yes.to_bits(), no.to_bits()))
}
