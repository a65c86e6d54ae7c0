//! The places of the eligible weights, and the moves of their values to and from them.

use super::Traces;
use super::aligned_vec::padding;
use super::trace_pass::BLOCK;
use crate::q_table::QTable;

impl Traces {
    /// The place of a weight; `None` if it is not eligible.
    #[inline(always)]
    pub(super) fn place(&self, weight: usize) -> Option<usize> {
        (self.slots[weight] as usize).checked_sub(self.base)
    }

    /// Makes room for this many more eligible weights.
    #[inline(always)]
    pub(super) fn grow(&mut self, additional: usize, storage: &mut Vec<f64>) {
        let places = self.count + additional;
        // There are as many values as traces, because passes work in whole blocks.
        if places > self.z.len() || self.base + self.z.len() > storage.len() {
            self.grow_to(places.next_multiple_of(BLOCK), storage);
        }
    }

    #[cold]
    fn grow_to(&mut self, places: usize, storage: &mut Vec<f64>) {
        let places = places.max(self.z.len());
        self.z.resize(places, 0.0);
        self.weights.resize(places, 0);
        storage.resize(self.base + places, 0.0);
    }

    /// Begins a step: the values of the eligible weights move to their places.
    #[inline(always)]
    pub fn begin_step(&mut self, table: &mut QTable) {
        if !self.moved {
            self.align(table.storage_mut());
            self.move_all(table.storage_mut(), |weight, place| (weight, place));
            self.moved = true;
        }
    }

    /// Moves all values back into the rows of the table.
    pub fn complete_table(&mut self, table: &mut QTable) {
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
        if place == self.z.len() {
            self.z.resize(place + BLOCK, 0.0);
            self.weights.resize(place + BLOCK, 0);
        }
        self.z[place] = trace;
        self.weights[place] = weight;
        self.slots[weight as usize] = (self.base + place) as u32;
        self.count += 1;
        self.smallest = self.smallest.min(trace.abs());
    }

    /// Sets the trace of a weight to 0.
    #[inline(always)]
    pub(super) fn remove_weight(&mut self, table: &mut QTable, weight: usize) {
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
        self.z[place] = self.z[last];
        self.z[last] = 0.0;
        self.weights[place] = moving;
        self.slots[moving as usize] = (len + place) as u32;
        // The order matters, because the two weights can be the same.
        self.slots[weight as usize] = weight;
        self.count = last;
    }

    /// z ← 0.
    pub fn clear(&mut self, table: &mut QTable) {
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
        self.z[..self.count].fill(0.0);
        self.count = 0;
        self.moved = false;
        self.smallest = f64::INFINITY;
        self.remove_zeros_at = 0;
    }
}

/// Equal if the traces are the same, whatever their places. The slots follow from the weights; the other fields only
/// determine when to look for traces at the cutoff.
impl PartialEq for Traces {
    fn eq(&self, other: &Self) -> bool {
        let parts = |traces: &Self| (traces.num_active(), traces.cutoff, traces.moved, traces.slots.len());
        let mut traces = self.weights.iter().zip(&*self.z).take(self.count);
        parts(self) == parts(other)
            && self.dense == other.dense
            && traces.all(|(&weight, &trace)| trace == 0.0 || other.get(weight as usize) == trace)
    }
}
