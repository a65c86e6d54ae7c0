//! The changes of traces by a visit to a state-action pair.

use std::hint::select_unpredictable;

use super::Traces;
use crate::features::ActiveFeatures;
use crate::q_table::QTable;

impl Traces {
    /// Replaces the traces of a state-action pair, one after the other, by a function of the trace. They become active.
    /// Returns Q(S, A).
    #[inline(always)]
    pub fn update(
        &mut self,
        table: &mut QTable,
        rows: impl ActiveFeatures,
        action: usize,
        change: impl Fn(f64) -> f64,
    ) -> f64 {
        let num_actions = table.num_actions();
        let weights = rows.as_ref().iter().map(|&row| row as usize * num_actions + action);
        self.grow(weights.len(), table.storage_mut());
        // Local variables, because fields of `self` and `table` would be loaded again for each weight.
        let base = self.base;
        let slots = self.slots.as_mut_slice();
        let traces = &mut *self.z;
        let places = &mut self.weights[..traces.len()];
        let (storage, mut count) = (table.storage_mut().as_mut_slice(), self.count);
        let (mut sum, mut smallest) = (None, self.smallest);
        for weight in weights {
            let slot = slots[weight] as usize;
            let value = storage[slot];
            // No branch, because it is hard to predict which weights are eligible.
            let new = slot < base;
            let place = select_unpredictable(new, count, slot.wrapping_sub(base));
            let trace = change(traces[place]);
            smallest = if trace.abs() < smallest { trace.abs() } else { smallest };
            traces[place] = trace;
            places[place] = weight as u32;
            storage[base + place] = value;
            slots[weight] = (base + place) as u32;
            count += usize::from(new);
            sum = Some(sum.map_or(value, |sum| sum + value));
        }
        (self.count, self.smallest) = (count, smallest);
        sum.unwrap_or(0.0)
    }

    /// Sets the traces of a state-action pair to 1. Returns Q(S, A).
    #[inline(always)]
    pub(super) fn replace(&mut self, table: &mut QTable, rows: impl ActiveFeatures, action: usize) -> f64 {
        let weights = weight_indices(rows.as_ref(), table.num_actions(), action);
        self.smallest = self.smallest.min(1.0);
        self.grow(weights.len(), table.storage_mut());
        // Local variables, as in `update`. They have 32 bits, so that no sum of them overflows and the compiler knows
        // that the value at a place with a trace is in the storage. `update` would be slower this way, because the next
        // pass waits for it.
        let (base, places) = (self.base as u32, self.z.len() as u32);
        let (slots, traces) = (self.slots.as_mut_slice(), &mut self.z[..places as usize]);
        let place_weights = &mut self.weights[..places as usize];
        let storage = &mut table.storage_mut()[..base as usize + places as usize];
        let mut count = self.count as u32;
        let mut sum = None;
        for weight in weights {
            let slot = &mut slots[weight as usize];
            let value = storage[*slot as usize];
            let new = *slot < base;
            let place = select_unpredictable(new, count, slot.wrapping_sub(base)) as usize;
            traces[place] = 1.0;
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

/// The indices of the weights of a state-action pair: [`QTable::weight_index`] in 32 bits, which suffice for all
/// weights with traces, because a vector register holds more such indices.
#[inline(always)]
fn weight_indices(rows: &[u32], num_actions: usize, action: usize) -> impl ExactSizeIterator<Item = u32> {
    let (num_actions, action) = (num_actions as u32, action as u32);
    rows.iter().map(move |&row| row * num_actions + action)
}

/// One of two numbers, without a branch. Not every instruction set can select between floats.
#[inline]
pub(super) fn select(condition: bool, yes: f64, no: f64) -> f64 {
    f64::from_bits(select_unpredictable(condition, yes.to_bits(), no.to_bits()))
}
