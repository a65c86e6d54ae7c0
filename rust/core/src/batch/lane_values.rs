//! What the lanes of a batch read from the values of their states.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use crate::numeric::{mask, select};

/// The value of an action in each lane.
#[inline(always)]
pub(super) fn values_of<const N: usize, const K: usize>(values: &[[f64; K]; N], actions: &[usize; K]) -> [f64; K] {
    let mut chosen = values[0];
    for (action, values) in values.iter().enumerate().skip(1) {
        for lane in 0..K {
            // A select between f64 would be an unpredictable branch where there are no vector registers.
            let is_chosen = mask(actions[lane] == action);
            chosen[lane] = f64::from_bits(select(is_chosen, values[lane].to_bits(), chosen[lane].to_bits()));
        }
    }
    chosen
}

/// The largest value in each lane.
#[inline(always)]
pub(super) fn largest<const N: usize, const K: usize>(values: &[[f64; K]; N]) -> [f64; K] {
    let mut largest = values[0];
    for values in &values[1..] {
        for lane in 0..K {
            largest[lane] = if values[lane] > largest[lane] { values[lane] } else { largest[lane] };
        }
    }
    largest
}
