//! A number with a dtype, and the promotion rules of `NumPy` 2 (NEP 50).

use std::hint::black_box;
use std::ops::{Add, Mul, Sub};

use super::squared;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};

/// A scalar together with its dtype.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scalar {
    /// A Python float: it adopts the dtype of the other operand.
    Python(f64),
    /// `np.float32`
    Single(f32),
    /// `np.float64`
    Double(f64),
}

impl Scalar {
    /// Applies `single` or `double` to both numbers, promoted to their common dtype.
    #[inline]
    fn with<T>(self, other: Self, single: impl Fn(f32, f32) -> T, double: impl Fn(f64, f64) -> T) -> T {
        match (self, other) {
            (Self::Single(a), Self::Single(b)) => single(a, b),
            (Self::Single(a), Self::Python(b)) => single(a, b as f32),
            (Self::Python(a), Self::Single(b)) => single(a as f32, b),
            _ => double(self.into(), other.into()),
        }
    }

    /// Like `with`, with the result as a scalar of the common dtype.
    #[inline]
    fn combine(self, other: Self, single: impl Fn(f32, f32) -> f32, double: impl Fn(f64, f64) -> f64) -> Self {
        let python = matches!((self, other), (Self::Python(_), Self::Python(_)));
        let wrap = if python { Self::Python } else { Self::Double };
        self.with(other, |a, b| Self::Single(single(a, b)), |a, b| wrap(double(a, b)))
    }

    /// `self < other`
    #[inline]
    pub fn less(self, other: Self) -> bool {
        self.with(other, |a, b| a < b, |a, b| a < b)
    }

    /// `self >= other`
    #[inline]
    pub fn greater_equal(self, other: Self) -> bool {
        self.with(other, |a, b| a >= b, |a, b| a >= b)
    }

    /// `self == other`
    #[inline]
    pub fn equal(self, other: Self) -> bool {
        self.with(other, |a, b| a == b, |a, b| a == b)
    }

    /// `self**2`, which keeps the dtype.
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

impl Persist for Scalar {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let (mut dtype, mut value) = match *self {
            Self::Python(value) => (0_u8, value),
            Self::Single(value) => (1, f64::from(value)),
            Self::Double(value) => (2, value),
        };
        (&mut dtype, &mut value).persist(checkpoint)?;
        *self = match dtype {
            0 => Self::Python(value),
            1 => Self::Single(value as f32),
            2 => Self::Double(value),
            _ => return Err(CheckpointError::Invalid("dtype")),
        };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_python_float_adopts_the_dtype_of_the_other_operand() {
        let (python, single) = (Scalar::Python(0.07), Scalar::Single(0.07));
        assert!(python.equal(single));
        assert!(!Scalar::Double(0.07).equal(single));
        assert_eq!(python + single, Scalar::Single(0.07 + 0.07));
        assert_eq!(python * python, Scalar::Python(0.07 * 0.07));
        assert_eq!(Scalar::Double(1.0) - Scalar::Single(0.5), Scalar::Double(0.5));
    }
}
