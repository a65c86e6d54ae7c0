//! Integers in lanes.

use std::ops::{Add, BitAnd, BitOr, BitXor, Mul, Sub};

use super::lane_type::{InLanes, lane_type};
use super::{Mask, Simd};

/// A u64 for each lane. Sums, differences and products wrap around.
#[derive(Clone, Copy, Debug)]
pub struct U64s<S: Simd, const K: usize>(pub(super) S, pub(super) S::U64s<K>);

lane_type!(
    U64s, u64, u64s, u64_array,
    Add add u64s_add, Sub sub u64s_sub, Mul mul u64s_mul, BitAnd bitand u64s_and, BitOr bitor u64s_or, BitXor bitxor u64s_xor
);

impl<S: Simd, const K: usize> U64s<S, K> {
    #[inline(always)]
    pub(crate) fn splat(simd: S, number: u64) -> Self {
        Self(simd, simd.u64s_splat(number))
    }

    /// Adds one in the lanes where the mask is true.
    #[inline(always)]
    pub(crate) fn incremented_where(self, mask: Mask<S, K>) -> Self {
        Self(self.0, self.0.u64s_increment(mask.1, self.1))
    }

    /// The products of the lower 32 bits.
    #[inline(always)]
    pub(crate) fn mul_lower(self, other: impl InLanes<S, Self>) -> Self {
        Self(self.0, self.0.u64s_mul_lower(self.1, other.in_lanes(self.0).1))
    }

    #[inline(always)]
    pub(crate) fn shift_left<const BITS: i32>(self) -> Self {
        Self(self.0, self.0.u64s_shift_left::<BITS, K>(self.1))
    }

    #[inline(always)]
    pub(crate) fn shift_right<const BITS: i32>(self) -> Self {
        Self(self.0, self.0.u64s_shift_right::<BITS, K>(self.1))
    }

    /// Rotates by a number below 64.
    #[inline(always)]
    pub(crate) fn rotate_right(self, bits: Self) -> Self {
        Self(self.0, self.0.u64s_rotate_right(self.1, bits.1))
    }

    #[inline(always)]
    pub(crate) fn less(self, other: impl InLanes<S, Self>) -> Mask<S, K> {
        Mask(self.0, self.0.u64s_less(self.1, other.in_lanes(self.0).1))
    }

    #[inline(always)]
    pub(crate) fn equal(self, other: impl InLanes<S, Self>) -> Mask<S, K> {
        Mask(self.0, self.0.u64s_equal(self.1, other.in_lanes(self.0).1))
    }
}

impl<S: Simd, const K: usize> InLanes<S, U64s<S, K>> for u64 {
    #[inline(always)]
    fn in_lanes(self, simd: S) -> U64s<S, K> {
        U64s::splat(simd, self)
    }
}
