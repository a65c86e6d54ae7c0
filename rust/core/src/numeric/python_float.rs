//! Float operations of Python and `NumPy` that differ from Rust's.

use std::hint::black_box;

/// Python's `x**2`: the platform's `pow`, which differs from `x * x` in the last bit in about one call in a thousand.
#[inline]
pub(crate) fn squared(x: f64) -> f64 {
    // With a constant exponent the optimiser would turn this into `x * x`.
    x.powf(black_box(2.0))
}

/// `np.clip(value, low, high)`. NaN stays NaN.
#[inline]
pub(crate) fn clip(value: f64, low: f64, high: f64) -> f64 {
    let raised = if value < low { low } else { value };
    if raised > high { high } else { raised }
}

/// `a % b` in Python and `NumPy`, for `b > 0`: the result has the sign of the divisor.
#[inline]
pub(crate) fn modulo(a: f64, b: f64) -> f64 {
    let remainder = a % b;
    if remainder == 0.0 {
        0.0
    } else if remainder < 0.0 {
        remainder + b
    } else {
        remainder
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_computed_by_the_platforms_pow() {
        let two = black_box(2.0);
        let differ = (1..100_000).map(|n| f64::from(n) / 977.0).filter(|x| {
            assert_eq!(squared(*x), x.powf(two));
            squared(*x) != x * x
        });
        // If the platform's `pow` is correctly rounded, none differ.
        assert!(differ.count() < 1000);
    }

    #[test]
    fn a_remainder_has_the_sign_of_the_divisor() {
        assert_eq!(modulo(-1.0, 3.0), 2.0);
        assert_eq!(modulo(7.5, 3.0), 1.5);
        assert!(modulo(-3.0, 3.0).is_sign_positive());
    }

    #[test]
    fn clipping_keeps_nan() {
        assert!(clip(f64::NAN, -1.0, 1.0).is_nan());
        assert_eq!(clip(3.0, -1.0, 1.0), 1.0);
    }
}
