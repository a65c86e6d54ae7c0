//! The updates of the tables of a batch, and of the values of the next rows.

use crate::features::LaneRows;
use crate::numeric::sum;
use crate::simd::{F64s, Simd, U64s, map};

/// Writes the value of an action in a row of each lane. Returns the values of the next rows after the write.
#[inline(always)]
pub(super) fn update_single_rows<S: Simd, R: LaneRows, const N: usize, const K: usize>(
    simd: S,
    tables: &mut [&mut [[f64; N]]; K],
    [rows, next_rows]: [&[R; K]; 2],
    actions: U64s<S, K>,
    updated: F64s<S, K>,
    mut next_values: [F64s<S, K>; N],
) -> [[f64; K]; N] {
    let weights = |rows: &[R; K]| U64s::new(simd, rows.map(|rows| rows.first() as u64)).mul_lower(N as u64);
    let weight = weights(rows) + actions;
    let (indices, numbers) = (weight.to_array(), updated.to_array());
    for lane in 0..K {
        tables[lane].as_flattened_mut()[indices[lane] as usize] = numbers[lane];
    }
    let next_weights = weights(next_rows);
    for (action, values) in next_values.iter_mut().enumerate() {
        // The update can have changed the next row.
        *values = (next_weights + action as u64).equal(weight).select(updated, *values);
    }
    map(next_values, F64s::to_array)
}

/// Adds a number to the values of an action in the rows of each lane. Returns the values of the next rows after the
/// addition.
#[inline(always)]
pub(super) fn update_rows<S: Simd, R: LaneRows, const N: usize, const K: usize>(
    tables: &mut [&mut [[f64; N]]; K],
    [rows, next_rows]: [&[R; K]; 2],
    actions: U64s<S, K>,
    changes: F64s<S, K>,
    next_values: [F64s<S, K>; N],
) -> [[f64; K]; N] {
    let (actions, changes) = (actions.to_array(), changes.to_array());
    let mut values = map(next_values, F64s::to_array);
    for lane in 0..K {
        let (action, table) = (actions[lane] as usize, &mut *tables[lane]);
        for row in rows[lane].indices() {
            table[row][action] += changes[lane];
        }
        // Most rows stay active, so the next value of the same action has nearly always changed.
        values[action][lane] = sum(next_rows[lane].indices().map(|row| table[row][action]));
    }
    values
}
