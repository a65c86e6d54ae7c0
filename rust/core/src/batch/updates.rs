//! The updates of the tables of a batch, and of the values that its lanes hold.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::episode_lanes::EpisodeLanes;
use crate::features::LaneRows;
use crate::q_table::sum_values;

/// Writes the value of an action in a row of each lane. `lanes` holds the rows that come next, and their values.
#[inline(always)]
pub(super) fn update_single_rows<R: LaneRows, const N: usize, const M: usize, const K: usize>(
    tables: &mut [&mut [[f64; N]]; K],
    rows: &[R; K],
    actions: &[usize; K],
    updated: &[f64; K],
    lanes: &mut EpisodeLanes<R, N, M, K>,
) {
    let weights: [usize; K] = std::array::from_fn(|lane| rows[lane].first() * N + actions[lane]);
    for lane in 0..K {
        tables[lane].as_flattened_mut()[weights[lane]] = updated[lane];
    }
    for (action, values) in lanes.values.iter_mut().enumerate() {
        for lane in 0..K {
            // The update can have changed the next row.
            let is_updated = lanes.rows[lane].first() * N + action == weights[lane];
            values[lane] = if is_updated { updated[lane] } else { values[lane] };
        }
    }
}

/// Adds a number to the values of an action in the rows of each lane. `lanes` holds the rows that come next, and their
/// values.
#[inline(always)]
pub(super) fn update_rows<R: LaneRows, const N: usize, const M: usize, const K: usize>(
    tables: &mut [&mut [[f64; N]]; K],
    rows: &[R; K],
    actions: &[usize; K],
    changes: &[f64; K],
    lanes: &mut EpisodeLanes<R, N, M, K>,
) {
    for lane in 0..K {
        let (action, table) = (actions[lane], &mut *tables[lane]);
        for row in rows[lane].indices() {
            table[row][action] += changes[lane];
        }
        // Most rows stay active, so that the next value of the same action has nearly always changed.
        lanes.values[action][lane] = sum_values(lanes.rows[lane].indices().map(|row| table[row][action]));
    }
}
