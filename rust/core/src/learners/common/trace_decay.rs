//! What an update does to all eligible weights and to their traces.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use std::hint::select_unpredictable;

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
        let falling = self.falling(factor, table.num_actions());
        let traces = &mut self.traces[..blocks * BLOCK];
        if let Some(falling) = falling {
            trace_passes::decay(traces, factor);
            if falling.rows != 0 {
                self.remove_falling(table, falling);
            }
        } else if trace_passes::decay_and_find(traces, factor, self.cutoff, &mut self.fallen[..blocks]) {
            self.remove_fallen(table.storage_mut());
        }
    }

    /// [`apply`](Self::apply) and [`decay`](Self::decay) in one pass.
    #[inline(always)]
    pub(super) fn apply_and_decay<const N: usize>(&mut self, table: &mut QTable<N>, step: f64, factor: f64) {
        let blocks = self.count.div_ceil(BLOCK);
        let falling = self.falling(factor, table.num_actions());
        let values = &mut table.storage_mut()[self.base..][..blocks * BLOCK];
        let traces = &mut self.traces[..blocks * BLOCK];
        if let Some(falling) = falling {
            trace_passes::apply_and_decay(values, traces, step, factor);
            if falling.rows != 0 {
                self.remove_falling(table, falling);
            }
        } else {
            let fallen = &mut self.fallen[..blocks];
            if trace_passes::apply_decay_and_find(values, traces, step, factor, self.cutoff, fallen) {
                self.remove_fallen(table.storage_mut());
            }
        }
    }

    /// Which traces the next decay takes to the cutoff, if the visits tell; `None` if all traces have to be looked at. Before
    /// the pass, because a processor that waits for the pass to know what to remove cannot begin the next step.
    #[inline(always)]
    fn falling(&mut self, factor: f64, num_actions: usize) -> Option<Falling> {
        let oldest = self.visits.end_step(factor);
        if none_falls(&mut self.smallest, factor, self.cutoff) {
            return Some(Falling { visit: 0, rows: 0 });
        }
        let Some(visit) = oldest else {
            self.visits.remember(factor, self.cutoff, &self.traces[..self.count]);
            return None;
        };
        Some(Falling { visit, rows: self.falling_rows(visit, factor, num_actions) })
    }

    /// The active rows of a visit whose traces the next decay takes to the cutoff, a bit each.
    // Not inlined, nor what removes them: learning without a cutoff, in the same loop, would be slower.
    #[inline(never)]
    fn falling_rows(&self, visit: usize, factor: f64, num_actions: usize) -> u64 {
        let (rows, action) = self.visits.get(visit);
        let traces = &*self.traces;
        let mut falling = 0;
        for (index, &row) in rows.iter().enumerate() {
            let slot = self.slots[(row * num_actions as u32 + action) as usize];
            // No branch, because which weights have been visited since is hard to predict.
            let place = (slot as usize).wrapping_sub(self.base);
            let eligible = place < traces.len();
            let trace = traces[select_unpredictable(eligible, place, 0)] * factor;
            falling |= u64::from(eligible & (trace.abs() <= self.cutoff)) << index;
        }
        falling
    }

    /// Sets these traces to 0, after the decay.
    #[inline(never)]
    fn remove_falling<const N: usize>(&mut self, table: &mut QTable<N>, mut falling: Falling) {
        while falling.rows != 0 {
            let (rows, action) = self.visits.get(falling.visit);
            let row = rows[falling.rows.trailing_zeros() as usize];
            falling.rows &= falling.rows - 1;
            // A row that hashing made active twice is removed once.
            self.remove_weight(table, table.weight_index(row, action as usize));
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

/// The traces of a visit that fall to the cutoff.
struct Falling {
    visit: usize,
    /// A bit for each of its rows.
    rows: u64,
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
