//! The arithmetic of Python and `NumPy`, where Rust's own would round differently.

use std::hint::black_box;
use std::ops::{Add, Mul, Sub};

/// Python's `x**2`: the platform's `pow`, which differs from `x * x` in about one call in a thousand.
#[inline]
pub(super) fn squared(x: f64) -> f64 {
    // A visible exponent would be folded into `x * x` when optimised.
    x.powf(black_box(2.0))
}

/// `np.clip`: NaN stays NaN.
#[inline]
pub(super) fn clip(value: f64, low: f64, high: f64) -> f64 {
    let raised = if value < low { low } else { value };
    if raised > high { high } else { raised }
}

/// The cosine and the sine of a single-precision angle within ±π/4, as `NumPy`'s vector code computes them: two
/// polynomials, each step one fused multiply-add (its `loops_trigonometric`; other angles are brought there first).
pub fn small_cosine_and_sine(x: f32) -> [f32; 2] {
    // x⁸, x⁶, x⁴, x², 1 and x⁹, x⁷, x⁵, x³
    const COSINE: [f32; 5] =
        [f32::from_bits(0x37cc_730b), f32::from_bits(0xbab6_036e), f32::from_bits(0x3d2a_aa9e), -0.5, 1.0];
    const SINE: [f32; 4] = [
        f32::from_bits(0x363e_9dde),
        f32::from_bits(0xb950_35dd),
        f32::from_bits(0x3c08_88cd),
        f32::from_bits(0xbe2a_aaab),
    ];
    let square = x * x;
    let polynomial = |factors: &[f32]| factors[1..].iter().fold(factors[0], |sum, &next| sum.mul_add(square, next));
    [polynomial(&COSINE), (polynomial(&SINE) * square).mul_add(x, x)]
}

/// Python's and `NumPy`'s `a % b` for b > 0.
#[inline]
pub(super) fn modulo(a: f64, b: f64) -> f64 {
    let rest = a % b;
    if rest == 0.0 {
        0.0
    } else if rest < 0.0 {
        rest + b
    } else {
        rest
    }
}

/// A number with the dtype that decides how `NumPy` 2 promotes it (NEP 50).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scalar {
    /// A Python float, which takes on the dtype of whatever it meets.
    Python(f64),
    /// `np.float32`
    Single(f32),
    /// `np.float64`
    Double(f64),
}

impl Scalar {
    /// Both in the dtype in which `NumPy` brings them together.
    #[inline]
    fn with<T>(self, other: Self, single: impl Fn(f32, f32) -> T, double: impl Fn(f64, f64) -> T) -> T {
        match (self, other) {
            (Self::Single(a), Self::Single(b)) => single(a, b),
            (Self::Single(a), Self::Python(b)) => single(a, b as f32),
            (Self::Python(a), Self::Single(b)) => single(a as f32, b),
            _ => double(self.into(), other.into()),
        }
    }

    #[inline]
    fn combine(self, other: Self, single: impl Fn(f32, f32) -> f32, double: impl Fn(f64, f64) -> f64) -> Self {
        let python = matches!((self, other), (Self::Python(_), Self::Python(_)));
        let wrap = if python { Self::Python } else { Self::Double };
        self.with(other, |a, b| Self::Single(single(a, b)), |a, b| wrap(double(a, b)))
    }

    /// `self < other`
    #[inline]
    pub fn below(self, other: Self) -> bool {
        self.with(other, |a, b| a < b, |a, b| a < b)
    }

    /// `self >= other`
    #[inline]
    pub fn at_least(self, other: Self) -> bool {
        self.with(other, |a, b| a >= b, |a, b| a >= b)
    }

    /// `self == other`
    #[inline]
    pub fn equals(self, other: Self) -> bool {
        self.with(other, |a, b| a == b, |a, b| a == b)
    }

    /// `self**2`, in its own dtype.
    #[inline]
    #[must_use]
    pub fn squared(self) -> Self {
        match self {
            Self::Single(x) => Self::Single(x.powf(black_box(2.0))),
            Self::Double(x) => Self::Double(squared(x)),
            Self::Python(x) => Self::Python(squared(x)),
        }
    }
}

impl Add for Scalar {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        self.combine(other, |a, b| a + b, |a, b| a + b)
    }
}

impl Sub for Scalar {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self.combine(other, |a, b| a - b, |a, b| a - b)
    }
}

impl Mul for Scalar {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        self.combine(other, |a, b| a * b, |a, b| a * b)
    }
}

impl From<Scalar> for f64 {
    #[inline]
    fn from(scalar: Scalar) -> Self {
        match scalar {
            Scalar::Single(number) => number.into(),
            Scalar::Python(number) | Scalar::Double(number) => number,
        }
    }
}

impl From<Scalar> for f32 {
    #[inline]
    fn from(scalar: Scalar) -> Self {
        match scalar {
            Scalar::Single(number) => number,
            Scalar::Python(number) | Scalar::Double(number) => number as Self,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_python_float_takes_on_the_dtype_that_it_meets() {
        let (python, single) = (Scalar::Python(0.07), Scalar::Single(0.07));
        assert!(python.equals(single));
        assert!(!Scalar::Double(0.07).equals(single));
        assert_eq!(python + single, Scalar::Single(0.07 + 0.07));
        assert_eq!(python * python, Scalar::Python(0.07 * 0.07));
        assert_eq!(Scalar::Double(1.0) - Scalar::Single(0.5), Scalar::Double(0.5));
    }

    #[test]
    fn a_square_is_the_platforms_power() {
        let two = black_box(2.0);
        let differ = (1..100_000).map(|n| f64::from(n) / 977.0).filter(|x| {
            assert_eq!(squared(*x), x.powf(two));
            squared(*x) != x * x
        });
        // Where the platform's power is exact to the last bit there are none.
        assert!(differ.count() < 1000);
    }

    #[test]
    fn a_remainder_has_the_sign_of_the_divisor() {
        assert_eq!(modulo(-1.0, 3.0), 2.0);
        assert_eq!(modulo(7.5, 3.0), 1.5);
        assert!(modulo(-3.0, 3.0).is_sign_positive());
    }

    #[test]
    fn small_angles_have_numpys_last_bit_where_it_is_not_the_nearest() {
        // As NumPy 2.4 printed them; the cosine's last bit is off in the first and the third, the sine's in the second.
        for [angle, cosine, sine] in [
            [0x3db4_86ce, 0x3f7f_018e, 0x3db4_4afb],
            [0x3db4_2547, 0x3f7f_02a1, 0x3db3_e9d4],
            [0xbd71_a4ec, 0x3f7f_8dfc, 0xbd71_810b],
        ] {
            assert_eq!(small_cosine_and_sine(f32::from_bits(angle)).map(f32::to_bits), [cosine, sine]);
        }
    }

    #[test]
    fn clipping_keeps_nan() {
        assert!(clip(f64::NAN, -1.0, 1.0).is_nan());
        assert_eq!(clip(3.0, -1.0, 1.0), 1.0);
    }
}
