//! Floating-point numbers in lanes.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use std::ops::{Add, Div, Mul, Sub};

use super::{Mask, Simd, U64s};

/// An f64 for each lane. `lanes * number` and the like use the number in each.
#[derive(Clone, Copy, Debug)]
pub struct F64s<S: Simd, const K: usize>(pub(super) S, pub(super) S::F64s<K>);

/// An f32 for each lane.
#[derive(Clone, Copy, Debug)]
pub struct F32s<S: Simd, const K: usize>(pub(super) S, pub(super) S::F32s<K>);

impl<S: Simd, const K: usize> F64s<S, K> {
    #[inline(always)]
    pub(crate) fn new(simd: S, array: [f64; K]) -> Self {
        Self(simd, simd.f64s(array))
    }

    #[inline(always)]
    pub(crate) fn splat(simd: S, number: f64) -> Self {
        Self(simd, simd.f64s_splat(number))
    }

    /// The numbers at `[0]` of each row, at `[1]`, and so on.
    #[inline(always)]
    pub(crate) fn columns<const N: usize>(simd: S, rows: [&[f64; N]; K]) -> [Self; N] {
        simd.f64s_columns(rows).map(|column| Self(simd, column))
    }

    #[inline(always)]
    pub(crate) fn from_bits(bits: U64s<S, K>) -> Self {
        Self(bits.0, bits.0.f64s_from_bits(bits.1))
    }

    #[inline(always)]
    pub(crate) fn to_bits(self) -> U64s<S, K> {
        U64s(self.0, self.0.f64s_to_bits(self.1))
    }

    #[inline(always)]
    pub(crate) fn to_f32s(self) -> F32s<S, K> {
        F32s(self.0, self.0.f64s_to_f32s(self.1))
    }

    #[inline(always)]
    pub(crate) fn to_array(self) -> [f64; K] {
        self.0.f64_array(self.1)
    }

    /// Replaces the number of one lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, number: f64) {
        let mut array = self.to_array();
        array[lane] = number;
        *self = Self::new(self.0, array);
    }

    /// `self * factor + summand`, rounded once.
    #[inline(always)]
    pub(crate) fn mul_add(self, factor: impl InLanes<S, Self>, summand: impl InLanes<S, Self>) -> Self {
        Self(self.0, self.0.f64s_mul_add(self.1, factor.in_lanes(self.0).1, summand.in_lanes(self.0).1))
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self::from_bits(self.to_bits() & i64::MAX.cast_unsigned())
    }

    #[inline(always)]
    pub(crate) fn negated(self) -> Self {
        Self::from_bits(self.to_bits() ^ i64::MIN.cast_unsigned())
    }

    /// `if self > other { self } else { other }`
    #[inline(always)]
    pub(crate) fn larger(self, other: Self) -> Self {
        Self(self.0, self.0.f64s_larger(self.1, other.1))
    }

    /// `np.clip`. The value must not be NaN.
    #[inline(always)]
    pub(crate) fn clip(self, low: f64, high: f64) -> Self {
        let simd = self.0;
        let value = simd.f64s_larger(simd.f64s_splat(low), self.1);
        Self(simd, simd.f64s_smaller(simd.f64s_splat(high), value))
    }

    #[inline(always)]
    pub(crate) fn less(self, other: impl InLanes<S, Self>) -> Mask<S, K> {
        Mask(self.0, self.0.f64s_less(self.1, other.in_lanes(self.0).1))
    }

    #[inline(always)]
    pub(crate) fn less_or_equal(self, other: impl InLanes<S, Self>) -> Mask<S, K> {
        Mask(self.0, self.0.f64s_less_or_equal(self.1, other.in_lanes(self.0).1))
    }

    #[inline(always)]
    pub(crate) fn greater(self, other: impl InLanes<S, Self>) -> Mask<S, K> {
        other.in_lanes(self.0).less(self)
    }

    #[inline(always)]
    pub(crate) fn greater_or_equal(self, other: impl InLanes<S, Self>) -> Mask<S, K> {
        other.in_lanes(self.0).less_or_equal(self)
    }

    #[inline(always)]
    pub(crate) fn equal(self, other: impl InLanes<S, Self>) -> Mask<S, K> {
        Mask(self.0, self.0.f64s_equal(self.1, other.in_lanes(self.0).1))
    }
}

impl<S: Simd, const K: usize> F32s<S, K> {
    #[inline(always)]
    pub(crate) fn to_f64s(self) -> F64s<S, K> {
        F64s(self.0, self.0.f32s_to_f64s(self.1))
    }

    #[inline(always)]
    pub(crate) fn to_array(self) -> [f32; K] {
        self.0.f32_array(self.1)
    }
}

/// What an operation in lanes takes: numbers in lanes, or one number for all of them.
pub(crate) trait InLanes<S, L> {
    fn in_lanes(self, simd: S) -> L;
}

impl<S: Simd, const K: usize> InLanes<S, Self> for F64s<S, K> {
    #[inline(always)]
    fn in_lanes(self, _simd: S) -> Self {
        self
    }
}

impl<S: Simd, const K: usize> InLanes<S, F64s<S, K>> for f64 {
    #[inline(always)]
    fn in_lanes(self, simd: S) -> F64s<S, K> {
        F64s::splat(simd, self)
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $operation:ident) => {
        impl<S: Simd, T: InLanes<S, Self>, const K: usize> $trait<T> for F64s<S, K> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: T) -> Self {
                Self(self.0, self.0.$operation(self.1, other.in_lanes(self.0).1))
            }
        }
    };
}

operator!(Add, add, f64s_add);
operator!(Sub, sub, f64s_sub);
operator!(Mul, mul, f64s_mul);
operator!(Div, div, f64s_div);

impl<S: Simd, const K: usize> Mul<F64s<S, K>> for f64 {
    type Output = F64s<S, K>;

    #[inline(always)]
    fn mul(self, other: F64s<S, K>) -> F64s<S, K> {
        self.in_lanes(other.0) * other
    }
}

impl<S: Simd, const K: usize> Sub<f32> for F32s<S, K> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: f32) -> Self {
        Self(self.0, self.0.f32s_sub(self.1, self.0.f32s_splat(other)))
    }
}
