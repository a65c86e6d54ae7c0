//! The bounds of the cosine with fused multiply-adds, which round once: fewer operations, and a single sine per cell.
//!
//! An angle is the middle of a cell plus a rest `r` of at most 2⁻⁷, and with cosine and sine of the middle
//! `cos(middle + r) = cos - sin·r + small`, where
//! `small = cos_lo - sin·(sin(r) - r) - cos·(1 - cos(r))` stays below 2⁻¹⁴. The first sum and the product are computed as
//! two numbers each, `hi + …` and `product + product_lo`, without an error: `|cos|` is at least 2⁻⁸ in the middle of every
//! cell, so its exponent is at least that of the product (T. Dekker's fast sum). In units of 2⁻⁶¹, the errors of `hi + lo`
//! are at most:
//!
//! | error | source |
//! |---|---|
//! | 0 | `r`: the subtractions are exact (Sterbenz) |
//! | 1 | `sin` is rounded to f64, by 2⁻⁵⁴, and multiplied by at most 2⁻⁷ |
//! | 0.05 | the roundings of `lo` and `small` and of `lo` plus or minus the bound, each below 2⁻¹⁴: six of at most 2⁻⁶⁸ |
//! | 0.02 | three roundings of `one_minus_cos`, which is at most 2⁻¹⁵, and of `sin_rest`, which is below 2⁻²³; the series, cut off at r⁹/9! and r⁸/8! |

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::PLATFORM_ERROR;
use super::table::{CELLS, ONE, ROUND_TO_CELL, cos_sin};

/// `[cos, cos_lo, -sin, 0]` in the middle of each cell, first of those from 0 on, then of the negative ones. The fourth
/// number aligns the entries.
static TABLE: [[f64; 4]; 2 * CELLS] = {
    let mut table = [[0.0; 4]; 2 * CELLS];
    let mut index = 0;
    while index < 2 * CELLS {
        let (cos, sin) = cos_sin(if index < CELLS { index as i128 } else { index as i128 - 2 * CELLS as i128 });
        let rounded = cos as f64;
        table[index] =
            [rounded / ONE as f64, (cos - rounded as i128) as f64 / ONE as f64, -(sin as f64) / ONE as f64, 0.0];
        index += 1;
    }
    table
};

/// The error bound of `hi + lo` and of the platform's cosine: 1.125 × 2⁻⁶¹ of the first.
const BOUND: f64 = 1.125 / 2_305_843_009_213_693_952.0 + PLATFORM_ERROR;

/// `f` of the least and of the largest value that the platform's cosine can have.
#[inline(always)]
pub(super) fn bounds<const K: usize>(angles: &[f64; K], f: impl Fn(usize, f64) -> f64) -> ([f64; K], [f64; K]) {
    let (mut rests, mut cells) = ([0.0; K], [0; K]);
    for lane in 0..K {
        let shifted = angles[lane] + ROUND_TO_CELL;
        rests[lane] = angles[lane] - (shifted - ROUND_TO_CELL);
        cells[lane] = shifted.to_bits();
    }
    let mut entries = [[0.0; K]; 3];
    for lane in 0..K {
        let entry = &TABLE[cells[lane] as usize % (2 * CELLS)];
        for (column, number) in entries.iter_mut().zip(entry) {
            column[lane] = *number;
        }
    }
    let (mut lower, mut upper) = ([0.0; K], [0.0; K]);
    for lane in 0..K {
        let (cos, cos_lo, minus_sin, rest) = (entries[0][lane], entries[1][lane], entries[2][lane], rests[lane]);
        let square = rest * rest;
        let sin_rest = rest * square * square.mul_add(square.mul_add(-1.0 / 5040.0, 1.0 / 120.0), -1.0 / 6.0);
        let one_minus_cos = square * square.mul_add(square.mul_add(1.0 / 720.0, -1.0 / 24.0), 0.5);
        let small = (-cos).mul_add(one_minus_cos, minus_sin.mul_add(sin_rest, cos_lo));
        let product = minus_sin * rest;
        let product_lo = minus_sin.mul_add(rest, -product);
        let hi = cos + product;
        let lo = ((cos - hi) + product) + (product_lo + small);
        lower[lane] = f(lane, hi + (lo - BOUND));
        upper[lane] = f(lane, hi + (lo + BOUND));
    }
    (lower, upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cells_cosine_is_large_enough_for_the_fast_sum() {
        assert!(TABLE.iter().all(|[cos, ..]| cos.abs() >= 1.0 / 256.0));
    }
}
