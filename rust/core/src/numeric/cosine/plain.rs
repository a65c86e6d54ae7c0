//! The bounds of the cosine with multiplications and additions that are rounded separately.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::PLATFORM_ERROR;
use super::table::{CELLS, FRACTION, ONE, ROUND_TO_CELL, cos_sin};

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

/// `f` of the least and of the largest value that the platform's cosine can have.
#[inline(always)]
pub(super) fn bounds<const K: usize>(angles: &[f64; K], f: impl Fn(usize, f64) -> f64) -> ([f64; K], [f64; K]) {
    let mut rests = [0.0; K];
    let mut entries = [[0.0; K]; 4];
    for lane in 0..K {
        let angle = angles[lane].abs();
        let shifted = angle + ROUND_TO_CELL;
        rests[lane] = angle - (shifted - ROUND_TO_CELL);
        let entry = &TABLE[shifted.to_bits() as usize % CELLS];
        for (column, number) in entries.iter_mut().zip(entry) {
            column[lane] = *number;
        }
    }
    let (mut lower, mut upper) = ([0.0; K], [0.0; K]);
    for lane in 0..K {
        let (cos, cos_lo) = (entries[0][lane], entries[1][lane]);
        let (sin, sin_lo) = (entries[2][lane], entries[3][lane]);
        let rest = rests[lane];
        let square = rest * rest;
        let cube = rest * square;
        let one_minus_cos = square * 0.5 - square * square * (1.0 / 24.0 - square * (1.0 / 720.0));
        let rest_minus_sin = cube * (1.0 / 6.0) - cube * square * (1.0 / 120.0 - square * (1.0 / 5040.0));
        let main = cos - sin * rest;
        let small = ((sin + sin_lo) * rest_minus_sin - sin_lo * rest) - cos * one_minus_cos;
        let hi = main + small;
        let lo = ((main - hi) + small) + (((cos - main) - sin * rest) + cos_lo);
        lower[lane] = f(lane, hi + (lo - BOUND));
        upper[lane] = f(lane, hi + (lo + BOUND));
    }
    (lower, upper)
}
