//! The bounds of the cosine with multiplications and additions that are rounded separately.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::PLATFORM_ERROR;
use super::table::{CELLS, FRACTION, ONE, ROUND_TO_CELL, cos_sin};
use crate::simd::{F64s, Simd};

/// The number of fractional bits of `sin_hi`: so few that its product with the rest of an angle is exact.
const SIN_HI_BITS: u32 = 7;

/// `[cos_hi, cos_lo, sin_hi, sin_lo]` in the middle of each cell: cosine and sine as sums of two numbers.
static TABLE: [[f64; 4]; CELLS] = {
    let mut table = [[0.0; 4]; CELLS];
    let mut cell = 0;
    while cell < CELLS {
        let (cos, sin) = cos_sin(cell as i128);
        let cos_hi = cos as f64;
        let sin_hi = (sin + (ONE >> (SIN_HI_BITS + 1))) >> (FRACTION - SIN_HI_BITS) << (FRACTION - SIN_HI_BITS);
        table[cell] = [
            cos_hi / ONE as f64,
            (cos - cos_hi as i128) as f64 / ONE as f64,
            sin_hi as f64 / ONE as f64,
            (sin - sin_hi) as f64 / ONE as f64,
        ];
        cell += 1;
    }
    table
};

/// The error bound of `hi + lo` and of the platform's cosine. Of the first: terms of 2⁻¹⁵ are rounded four times, and the
/// series is truncated below 2⁻⁷⁰, together less than 2⁻⁶⁵.
const BOUND: f64 = 1.0 / 36_893_488_147_419_103_232.0 + PLATFORM_ERROR;

/// The least and the largest value that the platform's cosine can have.
#[inline(always)]
pub(super) fn bounds<S: Simd, const K: usize>(simd: S, angles: F64s<S, K>) -> [F64s<S, K>; 2] {
    let angles = angles.abs();
    let shifted = angles + ROUND_TO_CELL;
    let rest = angles - (shifted - ROUND_TO_CELL);
    let cells = shifted.to_bits().to_array();
    let [cos, cos_lo, sin, sin_lo] = F64s::columns(simd, cells.map(|cell| &TABLE[cell as usize % CELLS]));
    let square = rest * rest;
    let cube = rest * square;
    let cos_minus_one = square * square * (square * (-1.0 / 720.0) + 1.0 / 24.0) - square * 0.5;
    let rest_minus_sin = cube * (1.0 / 6.0) - cube * square * (square * (-1.0 / 5040.0) + 1.0 / 120.0);
    let main = cos - sin * rest;
    let small = ((sin + sin_lo) * rest_minus_sin - sin_lo * rest) + cos * cos_minus_one;
    let hi = main + small;
    let lo = ((main - hi) + small) + (((cos - main) - sin * rest) + cos_lo);
    [hi + (lo - BOUND), hi + (lo + BOUND)]
}
