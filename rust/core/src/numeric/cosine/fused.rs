//! The bounds of the cosine with fused multiply-adds, which round once: fewer operations, and a single sine per cell.
//!
//! An angle is the middle of a cell plus a rest `r` of at most 2⁻⁷, and with cosine and sine of the middle, which are sums
//! of two numbers, `cos(middle + r) = cos - sin·r + small`, where
//! `small = cos_lo - sin_lo·r - sin·(sin(r) - r) - cos·(1 - cos(r))` stays below 2⁻¹⁴. The product and the first sum are
//! computed as two numbers each, without an error: `|cos|` is at least 2⁻⁸ in the middle of every cell, so its exponent is at
//! least that of the product (T. Dekker's fast sum). In units of 2⁻⁶¹, the errors of `hi + lo` are at most:
//!
//! | error | source |
//! |---|---|
//! | 0 | `r`: the subtractions are exact (Sterbenz) |
//! | 0.04 | the roundings of `small`, of it plus `product_lo`, of `lo`, and of `lo` plus or minus the bound, each at most 2⁻⁶⁸ |
//! | 0.04 | three roundings of `cos_minus_one`, which is at most 2⁻¹⁵, and those of `sin_rest`, which is below 2⁻²³; their series, cut off at r⁸/8! and r⁹/9! |
//!
//! Together they are below 1/8.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::PLATFORM_ERROR;
use super::table::{CELLS, ONE, ROUND_TO_CELL, cos_sin};
use crate::simd::{F64s, Simd};

/// `[cos, cos_lo, -sin, -sin_lo]` in the middle of each cell, first of those from 0 on, then of the negative ones.
static TABLE: [[f64; 4]; 2 * CELLS] = {
    let mut table = [[0.0; 4]; 2 * CELLS];
    let mut index = 0;
    while index < 2 * CELLS {
        let (cos, sin) = cos_sin(if index < CELLS { index as i128 } else { index as i128 - 2 * CELLS as i128 });
        let (cos_hi, sin_hi) = (cos as f64, sin as f64);
        table[index] = [cos_hi, (cos - cos_hi as i128) as f64, -sin_hi, (sin_hi as i128 - sin) as f64];
        let mut column = 0;
        while column < 4 {
            table[index][column] /= ONE as f64;
            column += 1;
        }
        index += 1;
    }
    table
};

/// The error bound of `hi + lo` and of the platform's cosine: 2⁻⁶⁴ of the first.
const BOUND: f64 = 1.0 / 18_446_744_073_709_551_616.0 + PLATFORM_ERROR;

/// The least and the largest value that the platform's cosine can have.
#[inline(always)]
pub(super) fn bounds<S: Simd, const K: usize>(simd: S, angles: F64s<S, K>) -> [F64s<S, K>; 2] {
    let shifted = angles + ROUND_TO_CELL;
    let rest = angles - (shifted - ROUND_TO_CELL);
    let cells = shifted.to_bits().to_array();
    let [cos, cos_lo, minus_sin, minus_sin_lo] =
        F64s::columns(simd, cells.map(|cell| &TABLE[cell as usize % (2 * CELLS)]));
    let square = rest * rest;
    let sin_rest = rest * square * square.mul_add(square.mul_add(-1.0 / 5040.0, 1.0 / 120.0), -1.0 / 6.0);
    let cos_minus_one = square * square.mul_add(square.mul_add(-1.0 / 720.0, 1.0 / 24.0), -0.5);
    let lows = minus_sin_lo.mul_add(rest, cos_lo);
    let small = cos.mul_add(cos_minus_one, minus_sin.mul_add(sin_rest, lows));
    let product = minus_sin * rest;
    let product_lo = minus_sin.mul_add(rest, product.negated());
    let hi = cos + product;
    let lo = ((cos - hi) + product) + (product_lo + small);
    [hi + (lo - BOUND), hi + (lo + BOUND)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cells_cosine_is_large_enough_for_the_fast_sum() {
        assert!(TABLE.iter().all(|[cos, ..]| cos.abs() >= 1.0 / 256.0));
    }
}
