//! Floating-point numbers in lanes.

use std::ops::{Add, Div, Mul, Sub};

use super::lane_type::{InLanes, lane_type};
use super::{Mask, Simd, U64s, map};

/// An f64 for each lane. In `lanes * number` and similar expressions, all lanes use the same number.
#[derive(Clone, Copy, Debug)]
pub struct F64s<S: Simd, const K: usize>(pub(super) S, pub(super) S::F64s<K>);

/// An f32 for each lane.
#[derive(Clone, Copy, Debug)]
pub struct F32s<S: Simd, const K: usize>(pub(super) S, pub(super) S::F32s<K>);

lane_type!(F64s, f64, f64s, f64_array, Add add f64s_add, Sub sub f64s_sub, Mul mul f64s_mul, Div div f64s_div);

impl<S: Simd, const K: usize> F64s<S, K> {
    #[inline(always)]
    pub(crate) fn splat(simd: S, number: f64) -> Self {
        Self(simd, simd.f64s_splat(number))
    }

    /// The columns of a matrix, given its rows: the numbers at index 0 of each row, then at index 1, and so on.
    #[inline(always)]
    pub(crate) fn columns<const N: usize>(simd: S, rows: [&[f64; N]; K]) -> [Self; N] {
        map(simd.f64s_columns(rows), |column| Self(simd, column))
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

impl<S: Simd, const K: usize> InLanes<S, F64s<S, K>> for f64 {
    #[inline(always)]
    fn in_lanes(self, simd: S) -> F64s<S, K> {
        F64s::splat(simd, self)
    }
}

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
