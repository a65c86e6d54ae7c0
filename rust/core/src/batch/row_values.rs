//! The values of the active rows of a lane.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use crate::features::LaneRows;
use crate::numeric::{mask, select};

/// The sums over the active rows, from left to right, as [`QTable::action_values`](crate::QTable::action_values).
#[inline(always)]
pub(super) fn row_values<const N: usize>(table: &[[f64; N]], rows: impl LaneRows) -> [f64; N] {
    let mut rows = rows.indices().map(|row| table[row]);
    let mut sums = rows.next().unwrap_or([0.0; N]);
    for values in rows {
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += value;
        }
    }
    sums
}

/// The sum for one action.
#[inline(always)]
pub(super) fn row_value<const N: usize>(table: &[[f64; N]], rows: impl LaneRows, action: usize) -> f64 {
    let mut values = rows.indices().map(|row| table[row][action]);
    let first = values.next().unwrap_or(0.0);
    values.fold(first, |sum, value| sum + value)
}

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
