//! Functions of the platform's cosine, computed in SIMD lanes with the same bits.
//!
//! [`map_cos`] computes `f(cos(angle))` for a monotone function `f`, such as the next velocity of the mountain car. It
//! computes the cosine as an unevaluated sum of two numbers, `hi + lo`, which is far more precise than one f64. glibc
//! guarantees that its cosine is within 0.55 units in the last place (ulp) of the true value, so the platform's cosine
//! lies between the roundings of `hi + (lo - bound)` and `hi + (lo + bound)`. Where `f` returns the same bits for both
//! and for `hi`, it returns the same bits for the platform's cosine, because it is monotone. Otherwise (about one step
//! in twenty) the platform's cosine is called.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

/// The table covers the angles from 0 to 4 in cells of width 1/64.
const CELLS: usize = 256;
const PER_UNIT: i128 = 64;
/// Larger angles use the platform's cosine.
const MAX_ANGLE: f64 = 3.99;

/// The number of fractional bits of the fixed-point numbers that the table is computed with.
const FRACTION: u32 = 110;
const ONE: i128 = 1 << FRACTION;
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

/// Cosine and sine of `cell / PER_UNIT` by their Taylor series, in units of 2⁻¹¹⁰.
const fn cos_sin(cell: i128) -> (i128, i128) {
    let (mut cos, mut sin) = (0, 0);
    let mut term = ONE;
    let mut power = 0;
    while term != 0 {
        match power % 4 {
            0 => cos += term,
            1 => sin += term,
            2 => cos -= term,
            _ => sin -= term,
        }
        power += 1;
        term = term * cell / (PER_UNIT * power);
    }
    (cos, sin)
}

/// Adding this rounds an angle to a whole number of cells and leaves that number in the low bits of the sum.
const ROUND_TO_CELL: f64 = 6_755_399_441_055_744.0 / PER_UNIT as f64; // 1.5 × 2⁵²
/// The exponent bits of an f64.
const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
/// glibc's error bound of 0.55 ulp, minus the half ulp of rounding, for a number between 1 and 2.
const BEYOND_HALF_ULP: f64 = 0.05 * f64::EPSILON;
/// The error bound of `hi + lo`: terms of 2⁻¹⁵ are rounded four times, and the series is truncated below 2⁻⁷⁰.
const APPROXIMATION_ERROR: f64 = 1.0 / 36_893_488_147_419_103_232.0; // 2⁻⁶⁵

/// Whether the platform's cosine has the error bound that [`map_cos`] relies on.
pub(crate) const IS_EXACT: bool = cfg!(all(target_os = "linux", target_env = "gnu"));

/// Writes `f(lane, angles[lane].cos())` to `values`, with the bits of the platform's cosine. `f` must be monotone in the
/// cosine.
#[inline(always)]
pub(crate) fn map_cos<const K: usize>(angles: &[f64; K], f: impl Fn(usize, f64) -> f64, values: &mut [f64; K]) {
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
    let mut uncertain = [0; K];
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
        let bound = f64::from_bits(hi.to_bits() & EXPONENT) * BEYOND_HALF_ULP + APPROXIMATION_ERROR;
        let value = f(lane, hi);
        values[lane] = value;
        let bits = value.to_bits();
        uncertain[lane] = (f(lane, hi + (lo - bound)).to_bits() ^ bits)
            | (f(lane, hi + (lo + bound)).to_bits() ^ bits)
            | u64::from(angles[lane].abs() > MAX_ANGLE);
    }
    if uncertain.iter().fold(0, |all, bits| all | bits) != 0 {
        for lane in 0..K {
            if uncertain[lane] != 0 {
                values[lane] = f(lane, platform(angles[lane]));
            }
        }
    }
}

/// Kept out of line, so that the SIMD code stays compact.
#[cold]
#[inline(never)]
fn platform(angle: f64) -> f64 {
    angle.cos()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Compares the velocity after a step; with a large `gravity` it depends on more of the cosine's last bits.
    fn check(angle: f64, velocity: f64, gravity: f64) {
        let f = |_, cosine: f64| velocity + cosine * -gravity;
        let mut values = [0.0; 2];
        map_cos(&[angle, -angle], f, &mut values);
        assert_eq!(values[0].to_bits(), f(0, angle.cos()).to_bits(), "cos({angle:?})");
        assert_eq!(values[1].to_bits(), f(0, (-angle).cos()).to_bits(), "cos(-{angle:?})");
    }

    #[test]
    fn zeros_and_cell_edges_match_the_platform() {
        use std::f64::consts::{FRAC_PI_2, PI};
        for center in (0..=256).map(|cell| f64::from(cell) / 128.0 * 2.0).chain([FRAC_PI_2, PI, MAX_ANGLE, 1e9]) {
            for offset in [0.0, 1.0 / 128.0, -1.0 / 128.0, 1e-17, -1e-12, 1e-300] {
                for gravity in [0.0025, 1.0, 1e6] {
                    check(center + offset, 0.01, gravity);
                    check(center + offset, 0.0, gravity);
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200_000))]

        #[test]
        fn the_bits_match_the_platform(
            angle in prop_oneof![-4.0..4.0, any::<f64>().prop_filter("finite", |angle| angle.is_finite())],
            velocity in prop_oneof![-0.07..0.07, Just(0.0)],
            gravity in prop_oneof![Just(0.0025), -2.0..2.0],
        ) {
            check(angle, velocity, gravity);
        }
    }
}
