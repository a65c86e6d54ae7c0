//! Cosine and sine of small angles, such as a pole's, computed in SIMD lanes with the platform's bits.
//!
//! Both are computed as an unevaluated sum `hi + lo`, which is far more precise than one f64. glibc's last operation is a
//! rounded addition, and what it rounds is close to the true value (`do_cos` and `do_sin` in
//! `sysdeps/ieee754/dbl-64/s_sin.c`, with or without fused multiply-adds). Rounding is monotone, so the platform's number
//! lies between the roundings of `hi + (lo - bound)` and `hi + (lo + bound)`, where `bound` is the sum of both errors.
//! Where these are equal, they are the platform's number. Otherwise (about one angle in twenty-five) the platform is called.
//!
//! The errors for angles of at most 1/4, where `u` is 2⁻⁵³, the relative error of a rounding:
//!
//! | of | at most | source |
//! |---|---|---|
//! | glibc's cosine | 3 × 2⁻⁶⁴ | the sum that is added to the cosine in the middle of a cell of width 2⁻⁷: it stays below sin(1/4) × 2⁻⁸ < 2⁻¹⁰, and three numbers of that size are rounded |
//! | `hi + lo` of the cosine | 2⁻⁶² | `x⁴ / 24` stays below 2⁻¹² and has a relative error of 6 u; `lo ± bound` is rounded twice |
//! | glibc's sine below 0.126 | 5.1 u abs(t) | `t`, the terms after the first, has five roundings |
//! | glibc's sine from there on | 3.1 × 2⁻⁶² | as its cosine, but the sum stays below 2⁻⁸ only |
//! | `hi + lo` of the sine | 5.2 u abs(t) | the same `t`, with one of the roundings in 1/6; the series is cut off at x¹⁵/15! |
//!
//! The fast sums `1 - half` and `x + t` lose nothing (T. Dekker).

use std::sync::OnceLock;

use crate::simd::{F64s, Portable, Simd};

/// Larger angles use the platform's functions.
const MAX_ANGLE: f64 = 0.25;
/// Smaller angles use them too: their terms may underflow, and their zeros have a sign.
const MIN_ANGLE: f64 = 1.0 / 1_048_576.0; // 2⁻²⁰

const TWO_POW_MINUS_53: f64 = f64::EPSILON / 2.0;
/// The error bound of both cosines, 2⁻⁶¹.
const COSINE_ERROR: f64 = TWO_POW_MINUS_53 / 256.0;
/// The error bound of each sine, in units of `t`.
const SINE_ERROR: f64 = 6.0 * TWO_POW_MINUS_53;
/// From this angle on, glibc's sine has the error bound `TABLE_ERROR`.
const TABLE_ANGLE: f64 = 0.125;
/// 2⁻⁶⁰
const TABLE_ERROR: f64 = TWO_POW_MINUS_53 / 128.0;

/// The platform's cosine and sine of each angle, to the bit. Without fused multiply-adds, the platform computes them all.
#[inline(always)]
pub(crate) fn cos_sin<S: Simd, const K: usize>(simd: S, angles: F64s<S, K>) -> [F64s<S, K>; 2] {
    if !S::HAS_FMA || !is_exact() {
        let angles = angles.to_array();
        return [angles.map(f64::cos), angles.map(f64::sin)].map(|numbers| F64s::new(simd, numbers));
    }
    let [lower, upper] = bounds(simd, angles);
    // Between the limits, up to rounding. NaN is not in the range.
    let in_range = (angles.abs() - 0.5 * MAX_ANGLE).abs().less_or_equal(0.5 * MAX_ANGLE - MIN_ANGLE);
    let cosine_is_certain = lower[0].to_bits().equal(upper[0].to_bits());
    let sine_is_certain = lower[1].to_bits().equal(upper[1].to_bits());
    let uncertain = !(in_range & cosine_is_certain & sine_is_certain);
    if uncertain.any() {
        let exact = platform_where(&uncertain.to_array(), &angles.to_array());
        let [cosines, sines] = [F64s::new(simd, exact[0]), F64s::new(simd, exact[1])];
        return [uncertain.select(cosines, lower[0]), uncertain.select(sines, lower[1])];
    }
    lower
}

/// The smallest and the largest cosine and sine that the platform can return.
#[inline(always)]
fn bounds<S: Simd, const K: usize>(simd: S, x: F64s<S, K>) -> [[F64s<S, K>; 2]; 2] {
    let square = x * x;
    let square_lo = x.mul_add(x, square.negated());

    let series = square.mul_add(1.0 / 479_001_600.0, -1.0 / 3_628_800.0);
    let series = square.mul_add(square.mul_add(series, 1.0 / 40_320.0), -1.0 / 720.0);
    let fourth = square * square * square.mul_add(series, 1.0 / 24.0);
    let half = square * 0.5;
    let one = F64s::splat(simd, 1.0);
    let hi = one - half;
    let lo = ((one - hi) - half) + square_lo.mul_add(-0.5, fourth);
    let cosines = [hi + (lo - COSINE_ERROR), hi + (lo + COSINE_ERROR)];

    let series = square.mul_add(1.0 / 6_227_020_800.0, -1.0 / 39_916_800.0);
    let series = square.mul_add(square.mul_add(series, 1.0 / 362_880.0), -1.0 / 5_040.0);
    let t = x * square * square.mul_add(square.mul_add(series, 1.0 / 120.0), -1.0 / 6.0);
    let hi = x + t;
    let lo = (x - hi) + t;
    let error = t.abs() * SINE_ERROR;
    let bound = error + x.abs().less(TABLE_ANGLE).select(error, F64s::splat(simd, TABLE_ERROR));
    let sines = [hi + (lo - bound), hi + (lo + bound)];
    [[cosines[0], sines[0]], [cosines[1], sines[1]]]
}

/// Whether the platform's cosine and sine satisfy the error bounds that [`cos_sin`] relies on. glibc's do. A different
/// C library in its place would be detected within a few thousand angles.
fn is_exact() -> bool {
    static IS_EXACT: OnceLock<bool> = OnceLock::new();
    cfg!(all(target_os = "linux", target_env = "gnu")) && *IS_EXACT.get_or_init(|| is_close(platform))
}

/// Whether cosine and sine lie within the bounds at angles spread over the range.
fn is_close(cos_sin: impl Fn(f64) -> [f64; 2]) -> bool {
    (-1999..=1999).filter(|&index| index != 0).all(|index| {
        let angle = f64::from(index) * (MAX_ANGLE / 1999.7);
        let simd = Portable;
        let [lower, upper] = bounds(simd, F64s::new(simd, [angle])).map(|functions| functions.map(F64s::to_array));
        (0..2).all(|function| (lower[function][0]..=upper[function][0]).contains(&cos_sin(angle)[function]))
    })
}

fn platform(angle: f64) -> [f64; 2] {
    [angle.cos(), angle.sin()]
}

/// The platform's cosines and sines of some angles. Kept out of line, so that the SIMD code stays compact.
#[inline(never)]
fn platform_where<const K: usize>(chosen: &[bool; K], angles: &[f64; K]) -> [[f64; K]; 2] {
    let mut numbers = [[0.0; K]; 2];
    for lane in (0..K).filter(|&lane| chosen[lane]) {
        [numbers[0][lane], numbers[1][lane]] = platform(angles[lane]);
    }
    numbers
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::simd::{SimdCode, SimdLevel};

    struct CosSin([f64; 4]);

    impl SimdCode for CosSin {
        const USES_AVX512: bool = true;

        type Output = [[f64; 4]; 2];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> [[f64; 4]; 2] {
            cos_sin(simd, F64s::new(simd, self.0)).map(F64s::to_array)
        }
    }

    /// Compares both forms with the platform: the fused one only if this processor has the instructions.
    fn check(angles: [f64; 4]) {
        let expected = [angles.map(f64::cos), angles.map(f64::sin)];
        for level in SimdLevel::available() {
            let found = level.run(CosSin(angles));
            assert_eq!(found.map(|all| all.map(f64::to_bits)), expected.map(|all| all.map(f64::to_bits)), "{angles:?}");
        }
    }

    #[test]
    fn zeros_and_the_ends_of_ranges_match_the_platform() {
        for center in [0.0, MIN_ANGLE, 0.125, 0.126, MAX_ANGLE, 0.855_469, 1.0, 1e9, f64::MIN_POSITIVE, f64::INFINITY] {
            for angle in [center.next_down(), center, center.next_up()] {
                check([angle, -angle, 0.9 * angle, -1.1 * angle]);
            }
        }
    }

    /// The angles whose sines are the closest to powers of two, those in the middle of a cell of glibc's, and those at its
    /// ends, each with its neighbours.
    #[test]
    fn edges_of_rounding_and_of_cells_match_the_platform() {
        let powers = (2..22).map(|exponent| 0.5_f64.powi(exponent).asin());
        for center in powers.chain((1..64).map(|index| f64::from(index) / 256.0)) {
            for bits in center.to_bits() - 40..center.to_bits() + 40 {
                let angle = f64::from_bits(bits);
                check([angle, -angle, 0.25 - angle, angle - 0.25]);
            }
        }
    }

    #[test]
    fn functions_with_larger_errors_are_not_relied_on() {
        assert!(is_close(platform));
        assert!(!is_close(|angle| [platform(angle)[0], angle.sin().next_up()]));
        assert!(!is_close(|angle| [angle.cos().next_down(), platform(angle)[1]]));
        assert!(!is_close(|angle| [angle.cos(), (angle as f32).sin().into()]));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100_000))]

        #[test]
        fn the_bits_match_the_platform(
            angles in prop::array::uniform4(prop_oneof![
                4 => -MAX_ANGLE..MAX_ANGLE,
                1 => -0.001..0.001,
                1 => any::<f64>().prop_filter("finite", |angle| angle.is_finite()),
            ]),
        ) {
            check(angles);
        }
    }
}
