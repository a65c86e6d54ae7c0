//! Functions of the platform's cosine, computed in SIMD lanes with the same bits.
//!
//! [`map_cos`] computes `f(cos(angle))` for a monotone function `f`, such as the next velocity of the mountain car. It
//! computes the cosine as an unevaluated sum of two numbers, `hi + lo`, which is far more precise than one f64. glibc's
//! last operation is a rounded addition, and what it rounds is within 3.5 × 2⁻⁶² of the cosine. Rounding is monotone, so
//! the platform's cosine lies between the roundings of `hi + (lo - bound)` and `hi + (lo + bound)`, where `bound` is that
//! and the error of `hi + lo`. Where `f` returns the same bits for both, it returns the same bits for the platform's
//! cosine, because it is monotone. Otherwise (about one step in a hundred) the platform's cosine is called.
//!
//! glibc's error follows from `do_cos` and `do_sin` in `sysdeps/ieee754/dbl-64/s_sin.c`, with or without fused
//! multiply-adds; before version 2.28 the result was always the correctly rounded one. An angle, reduced to at most 0.86 with
//! more than 100 bits, is the middle of a cell of width 2⁻⁷ plus a rest, and what is added to the cosine of the middle stays
//! below 2⁻⁸, so that each of its roundings errs by at most 2⁻⁶². There are four: of the rest, of its sine (both then
//! multiplied by at most 0.76), of the product with the sine of the middle and of the last sum. Reduced angles below 0.126
//! have a shorter series, whose terms after the first are below 2⁻¹¹ and are rounded six times.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

mod fused;
mod plain;
mod table;

use std::sync::OnceLock;

/// Larger angles use the platform's cosine.
const MAX_ANGLE: f64 = 3.99;

/// The error bound of the number that glibc rounds to the cosine, 2⁻⁶⁰.
const PLATFORM_ERROR: f64 = 1.0 / 1_152_921_504_606_846_976.0;

/// Whether the platform's cosine has the error bound that [`map_cos`] relies on: glibc's does. Another C library in its
/// place would show itself at a few thousand angles.
pub(crate) fn is_exact() -> bool {
    static IS_EXACT: OnceLock<bool> = OnceLock::new();
    cfg!(all(target_os = "linux", target_env = "gnu")) && *IS_EXACT.get_or_init(|| is_close(platform))
}

/// Whether a cosine lies between the bounds at angles spread over all cells.
fn is_close(cosine: impl Fn(f64) -> f64) -> bool {
    (-1999..=1999).all(|index| {
        let angle = f64::from(index) * (MAX_ANGLE / 1999.7);
        let ([lower], [upper]) = plain::bounds(&[angle], |_, cosine| cosine);
        (lower..=upper).contains(&cosine(angle))
    })
}

/// Writes `f(lane, angles[lane].cos())` to `values`, with the bits of the platform's cosine. `f` must be monotone in the
/// cosine. `FUSED` is that of the [`SimdLevel`](super::SimdLevel) which the code is compiled for.
#[inline(always)]
pub(crate) fn map_cos<const FUSED: bool, const K: usize>(
    angles: &[f64; K],
    f: impl Fn(usize, f64) -> f64,
    values: &mut [f64; K],
) {
    let (lower, upper) = if FUSED { fused::bounds(angles, &f) } else { plain::bounds(angles, &f) };
    let mut uncertain = [0; K];
    for lane in 0..K {
        values[lane] = lower[lane];
        // NaN is not in the range.
        let in_range = angles[lane].abs() <= MAX_ANGLE;
        uncertain[lane] = (lower[lane].to_bits() ^ upper[lane].to_bits()) | u64::from(!in_range);
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
    use crate::numeric::{SimdCode, SimdLevel};

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
        type Output = [f64; 2];

        #[inline(always)]
        fn run<const FUSED: bool>(self) -> [f64; 2] {
            let mut values = [0.0; 2];
            map_cos::<FUSED, 2>(&self.angles, |_, cosine| self.after(cosine), &mut values);
            values
        }
    }

    /// Compares both forms with the platform: the fused one where this processor has the instructions.
    fn check(angle: f64, velocity: f64, gravity: f64) {
        let velocities = Velocities { angles: [angle, -angle], velocity, gravity };
        let expected = velocities.angles.map(|angle| velocities.after(angle.cos()).to_bits());
        for level in [SimdLevel::PLAIN, SimdLevel::detect()] {
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
