//! What an update does to all eligible weights and to their traces.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::eligible_weights::EligibleWeights;
use super::trace_passes::{self, BLOCK};
use crate::q_table::QTable;

impl EligibleWeights {
    /// Adds to each eligible weight a step times its trace.
    #[inline(always)]
    pub(super) fn apply<const N: usize>(&mut self, table: &mut QTable<N>, step: f64) {
        let len = self.count.next_multiple_of(BLOCK);
        let values = &mut table.storage_mut()[self.base..][..len];
        trace_passes::apply(values, &self.traces[..len], step);
    }

    /// Adds to each eligible weight a function of its index and its trace.
    pub(super) fn apply_each<const N: usize>(&mut self, table: &mut QTable<N>, change: impl Fn(usize, f64) -> f64) {
        let values = &mut table.storage_mut()[self.base..];
        let traces = self.weights.iter().zip(&*self.traces).take(self.count);
        for (value, (&weight, &trace)) in values.iter_mut().zip(traces) {
            *value += change(weight as usize, trace);
        }
    }

    /// Multiplies the traces by a factor; those whose magnitudes fall to the cutoff become 0.
    #[inline(always)]
    pub(super) fn decay<const N: usize>(&mut self, table: &mut QTable<N>, factor: f64) {
        let blocks = self.count.div_ceil(BLOCK);
        let traces = &mut self.traces[..blocks * BLOCK];
        if none_falls(&mut self.smallest, factor, self.cutoff) {
            trace_passes::decay(traces, factor);
        } else if trace_passes::decay_and_find(traces, factor, self.cutoff, &mut self.fallen[..blocks]) {
            self.remove_fallen(table.storage_mut());
        }
    }

    /// [`apply`](Self::apply) and [`decay`](Self::decay) in one pass.
    #[inline(always)]
    pub(super) fn apply_and_decay<const N: usize>(&mut self, table: &mut QTable<N>, step: f64, factor: f64) {
        let blocks = self.count.div_ceil(BLOCK);
        let values = &mut table.storage_mut()[self.base..][..blocks * BLOCK];
        let traces = &mut self.traces[..blocks * BLOCK];
        if none_falls(&mut self.smallest, factor, self.cutoff) {
            trace_passes::apply_and_decay(values, traces, step, factor);
        } else {
            let fallen = &mut self.fallen[..blocks];
            if trace_passes::apply_decay_and_find(values, traces, step, factor, self.cutoff, fallen) {
                self.remove_fallen(table.storage_mut());
            }
        }
    }

    /// Sets to 0 the traces at or below the cutoff, in the blocks where a pass has found some. From the last one on, so that
    /// the weight that takes the place of another one has been looked at.
    #[inline(always)]
    fn remove_fallen(&mut self, storage: &mut [f64]) {
        let blocks = self.count.div_ceil(BLOCK);
        let mut count = 0;
        // No branches, because where traces fall is hard to predict.
        for (block, &fallen) in self.fallen[..blocks].iter().enumerate() {
            self.fallen_blocks[count] = block as u32;
            count += usize::from(fallen);
        }
        for index in (0..count).rev() {
            let block = self.fallen_blocks[index] as usize;
            let mut places = trace_passes::fallen_places(&self.traces.as_chunks().0[block], self.cutoff);
            while places != 0 {
                let place = places.ilog2();
                places ^= 1 << place;
                self.remove(storage, block * BLOCK + place as usize);
            }
        }
    }
}

/// Whether a decay leaves all traces above the cutoff. The bound decays with them: the product with a smaller magnitude is
/// not greater after rounding either.
#[inline(always)]
fn none_falls(smallest: &mut f64, factor: f64, cutoff: f64) -> bool {
    // The maximum, because ∞ · 0 is no bound.
    *smallest = (*smallest * factor.abs()).max(0.0);
    let none = *smallest > cutoff;
    // Otherwise the others become 0.
    *smallest = smallest.max(cutoff);
    none
}
