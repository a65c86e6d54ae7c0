//! What a visit does to the traces of a state-action pair.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use std::hint::select_unpredictable;

use super::eligible_weights::EligibleWeights;
use crate::q_table::QTable;

impl EligibleWeights {
    /// Replaces the traces of some weights, one after the other, by a function of the trace. Returns the sum of the values
    /// from left to right.
    #[inline(always)]
    pub(super) fn update<const N: usize>(
        &mut self,
        table: &mut QTable<N>,
        weights: impl ExactSizeIterator<Item = u32>,
        change: impl Fn(f64) -> f64,
    ) -> f64 {
        let mut smallest = self.smallest;
        let sum = self.change(table, weights, |trace| {
            let trace = change(trace);
            smallest = if trace.abs() < smallest { trace.abs() } else { smallest };
            trace
        });
        self.smallest = smallest;
        sum
    }

    /// Sets the traces of some weights to 1. Returns the sum of the values from left to right.
    #[inline(always)]
    pub(super) fn replace<const N: usize>(
        &mut self,
        table: &mut QTable<N>,
        weights: impl ExactSizeIterator<Item = u32>,
    ) -> f64 {
        self.smallest = self.smallest.min(1.0);
        self.change(table, weights, |_| 1.0)
    }

    /// [`update`](Self::update) of the traces alone.
    #[inline(always)]
    fn change<const N: usize>(
        &mut self,
        table: &mut QTable<N>,
        weights: impl ExactSizeIterator<Item = u32>,
        mut change: impl FnMut(f64) -> f64,
    ) -> f64 {
        self.grow(weights.len(), table.storage_mut());
        // Local variables: behind `self` and `table` each weight would load them again. In 32 bits, so that no sum of them
        // overflows: the compiler then knows that the value at a place that has a trace is in the storage.
        let (base, places) = (self.base as u32, self.traces.len() as u32);
        let (slots, traces) = (self.slots.as_mut_slice(), &mut self.traces[..places as usize]);
        let place_weights = &mut self.weights[..places as usize];
        let storage = &mut table.storage_mut()[..base as usize + places as usize];
        let mut count = self.count as u32;
        let mut sum = None;
        for weight in weights {
            let slot = &mut slots[weight as usize];
            let value = storage[*slot as usize];
            // No branch, because whether a weight is eligible is hard to predict.
            let new = *slot < base;
            let place = select_unpredictable(new, count, slot.wrapping_sub(base)) as usize;
            let trace = &mut traces[place];
            *trace = change(select(new, 0.0, *trace));
            place_weights[place] = weight;
            storage[base as usize + place] = value;
            *slot = base + place as u32;
            count += u32::from(new);
            sum = Some(sum.map_or(value, |sum| sum + value));
        }
        self.count = count as usize;
        sum.unwrap_or(0.0)
    }
}

/// One of two numbers, without a branch. Not every instruction set can select between floats.
#[inline]
pub(super) fn select(condition: bool, yes: f64, no: f64) -> f64 {
    f64::from_bits(select_unpredictable(condition, yes.to_bits(), no.to_bits()))
}
