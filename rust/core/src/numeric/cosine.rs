//! Functions of the platform's cosine, computed in SIMD lanes with the same bits.
//!
//! [`map_cos`] computes `f(cos(angle))` for a monotone function `f`, such as the next velocity of the mountain car. It
//! computes the cosine as an unevaluated sum of two numbers, `hi + lo`, which is far more precise than one f64. glibc's
//! last operation is a rounded addition, and what it rounds is within 3.5 × 2⁻⁶² of the cosine. Rounding is monotone, so
//! the platform's cosine lies between the roundings of `hi + (lo - bound)` and `hi + (lo + bound)`, where `bound` is that
//! and the error of `hi + lo`. Where `f` returns the same bits for both, it returns the same bits for the platform's
//! cosine, because it is monotone. Otherwise (about one step in a hundred) the platform's cosine is called, and always on
//! processors without fused multiply-adds.
//!
//! glibc's error follows from `do_cos` and `do_sin` in `sysdeps/ieee754/dbl-64/s_sin.c`, with or without fused
//! multiply-adds; before version 2.28 the result was always the correctly rounded one. An angle, reduced to at most 0.86 with
//! more than 100 bits, is the middle of a cell of width 2⁻⁷ plus a rest, and what is added to the cosine of the middle stays
//! below 2⁻⁸, so that each of its roundings errs by at most 2⁻⁶². There are four: of the rest, of its sine (both then
//! multiplied by at most 0.76), of the product with the sine of the middle and of the last sum. Reduced angles below 0.126
//! have a shorter series, whose terms after the first are below 2⁻¹¹ and are rounded six times.
//!
//! For `hi + lo`, an angle is the middle of a cell plus a rest `r` of at most 2⁻⁷, and with cosine and sine of the middle,
//! which are sums of two numbers, `cos(middle + r) = cos - sin·r + small`, where
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

use std::sync::OnceLock;

use crate::simd::{F64s, Portable, Simd};

/// Larger angles use the platform's cosine.
const MAX_ANGLE: f64 = 3.99;

/// The error bound of the number that glibc rounds to the cosine, 2⁻⁶⁰.
const PLATFORM_ERROR: f64 = 1.0 / 1_152_921_504_606_846_976.0;
/// The error bound of `hi + lo` and of the platform's cosine: 2⁻⁶⁴ of the first.
const BOUND: f64 = 1.0 / 18_446_744_073_709_551_616.0 + PLATFORM_ERROR;

/// Angles from -4 to 4 are divided into cells of width 1/64.
const CELLS_PER_UNIT: i128 = 64;
/// The number of cells from 0 to 4.
const CELLS: usize = 256;

/// The number of fractional bits of the fixed-point numbers that the table is computed with.
const FRACTION: u32 = 110;
const ONE: i128 = 1 << FRACTION;

/// Adding this rounds an angle to a whole number of cells and leaves that number in the low bits of the sum, negative
/// ones in two's complement.
const ROUND_TO_CELL: f64 = 6_755_399_441_055_744.0 / CELLS_PER_UNIT as f64; // 1.5 × 2⁵²

/// Cosine and sine of `cell / CELLS_PER_UNIT` by their Taylor series, in units of 2⁻¹¹⁰. Each of some 60 terms is cut
/// off by less than a unit. `cell` may be negative.
const fn in_middle(cell: i128) -> (i128, i128) {
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
        term = term * cell / (CELLS_PER_UNIT * power);
    }
    (cos, sin)
}

/// `[cos, cos_lo, -sin, -sin_lo]` in the middle of each cell, first of those from 0 on, then of the negative ones.
static TABLE: [[f64; 4]; 2 * CELLS] = {
    let mut table = [[0.0; 4]; 2 * CELLS];
    let mut index = 0;
    while index < 2 * CELLS {
        let (cos, sin) = in_middle(if index < CELLS { index as i128 } else { index as i128 - 2 * CELLS as i128 });
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

/// Whether the platform's cosine satisfies the error bound that [`map_cos`] relies on. glibc's does. A different C
/// library in its place would be detected within a few thousand angles.
pub(crate) fn is_exact() -> bool {
    static IS_EXACT: OnceLock<bool> = OnceLock::new();
    cfg!(all(target_os = "linux", target_env = "gnu")) && *IS_EXACT.get_or_init(|| is_close(f64::cos))
}

/// Whether a cosine lies within the bounds at angles spread over all cells.
fn is_close(cosine: impl Fn(f64) -> f64) -> bool {
    (-1999..=1999).all(|index| {
        let angle = f64::from(index) * (MAX_ANGLE / 1999.7);
        let simd = Portable;
        let [[lower], [upper]] = bounds(simd, F64s::new(simd, [angle])).map(F64s::to_array);
        (lower..=upper).contains(&cosine(angle))
    })
}

/// `f` of the cosine of each angle, with the bits of the platform's cosine. `f` must be monotone in the cosine.
#[inline(always)]
pub(crate) fn map_cos<S: Simd, const K: usize>(
    simd: S,
    angles: F64s<S, K>,
    f: impl Fn(F64s<S, K>) -> F64s<S, K>,
) -> F64s<S, K> {
    // All processors of 64-bit ARM have fused multiply-adds. Tests compare their form, too.
    if !S::HAS_FMA && !cfg!(any(test, target_arch = "aarch64")) {
        return f(F64s::new(simd, angles.to_array().map(f64::cos)));
    }
    let [lower, upper] = bounds(simd, angles);
    let [lower, upper] = [f(lower), f(upper)];
    // NaN is not in the range.
    let certain = lower.to_bits().equal(upper.to_bits()) & angles.abs().less_or_equal(MAX_ANGLE);
    let uncertain = !certain;
    if uncertain.any() {
        let cosines = platform_where(&uncertain.to_array(), &angles.to_array());
        return uncertain.select(f(F64s::new(simd, cosines)), lower);
    }
    lower
}

/// The platform's cosines of some angles. Kept out of line, so that the SIMD code stays compact.
#[inline(never)]
fn platform_where<const K: usize>(chosen: &[bool; K], angles: &[f64; K]) -> [f64; K] {
    std::array::from_fn(|lane| if chosen[lane] { angles[lane].cos() } else { 0.0 })
}

/// The smallest and the largest value of `f` for the cosines that the platform can return.
#[inline(always)]
fn bounds<S: Simd, const K: usize>(simd: S, angles: F64s<S, K>) -> [F64s<S, K>; 2] {
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
    use proptest::prelude::*;

    use super::*;
    use crate::simd::{SimdCode, SimdLevel};

    /// Velocities after a step; with a large `gravity` they depend on more of the cosine's last bits.
    struct Velocities {
        angles: [f64; 2],
        velocity: f64,
        gravity: f64,
    }

    impl Velocities {
        fn after(&self, cosine: f64) -> f64 {
            self.velocity + cosine * -self.gravity
        }
    }

    impl SimdCode for &Velocities {
        const USES_AVX512: bool = true;

        type Output = [f64; 2];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> [f64; 2] {
            let after = |cosine| F64s::splat(simd, self.velocity) + cosine * -self.gravity;
            map_cos(simd, F64s::new(simd, self.angles), after).to_array()
        }
    }

    /// Compares each level with the platform.
    fn check(angle: f64, velocity: f64, gravity: f64) {
        let velocities = Velocities { angles: [angle, -angle], velocity, gravity };
        let expected = velocities.angles.map(|angle| velocities.after(angle.cos()).to_bits());
        for level in SimdLevel::available() {
            let values = level.run(&velocities).map(f64::to_bits);
            assert_eq!(values, expected, "cos({angle:?}) with gravity {gravity:?}, {level:?}");
        }
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
        assert!(f64::is_nan(
            SimdLevel::PLAIN.run(&Velocities { angles: [f64::NAN; 2], velocity: 0.0, gravity: 1.0 })[0]
        ));
    }

    /// The angles whose cosines are the closest to powers of two, and their neighbours.
    #[test]
    fn cosines_near_powers_of_two_match_the_platform() {
        for exponent in 0..60 {
            let power = 0.5_f64.powi(exponent);
            for center in [power.acos(), (-power).acos()] {
                let bits = center.to_bits();
                for angle in (bits.saturating_sub(40)..bits + 40).map(f64::from_bits) {
                    check(angle, 0.0, 1.0);
                }
            }
        }
    }

    #[test]
    fn a_cosine_with_a_larger_error_is_not_relied_on() {
        assert!(is_close(f64::cos));
        assert!(!is_close(|angle| f64::from_bits(angle.cos().to_bits() + 1)));
        assert!(!is_close(|angle| f64::from(angle.cos() as f32)));
        assert!(!is_close(|angle| (angle + std::f64::consts::FRAC_PI_2).sin()));
    }

    #[test]
    fn every_cells_cosine_is_large_enough_for_the_fast_sum() {
        assert!(TABLE.iter().all(|[cos, ..]| cos.abs() >= 1.0 / 256.0));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200_000))]

        #[test]
        fn the_bits_match_the_platform(
            angle in prop_oneof![-4.0..4.0, any::<f64>().prop_filter("finite", |angle| angle.is_finite())],
            velocity in prop_oneof![-0.07..0.07, Just(0.0)],
            gravity in prop_oneof![Just(0.0025), Just(1.0), -2.0..2.0],
        ) {
            check(angle, velocity, gravity);
        }
    }
}
