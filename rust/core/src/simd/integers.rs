//! Integers in lanes.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use std::ops::{Add, BitAnd, BitOr, BitXor, Mul, Sub};

use super::floats::InLanes;
use super::{Mask, Simd};

/// A u64 for each lane. Sums, differences and products wrap around.
#[derive(Clone, Copy, Debug)]
pub struct U64s<S: Simd, const K: usize>(pub(super) S, pub(super) S::U64s<K>);

impl<S: Simd, const K: usize> U64s<S, K> {
    #[inline(always)]
    pub(crate) fn new(simd: S, array: [u64; K]) -> Self {
        Self(simd, simd.u64s(array))
    }

    #[inline(always)]
    pub(crate) fn splat(simd: S, number: u64) -> Self {
        Self(simd, simd.u64s_splat(number))
    }

    #[inline(always)]
    pub(crate) fn to_array(self) -> [u64; K] {
        self.0.u64_array(self.1)
    }

    /// Replaces the number of one lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, number: u64) {
        let mut array = self.to_array();
        array[lane] = number;
        *self = Self::new(self.0, array);
    }

    /// One more in the lanes where the mask is true.
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

impl<S: Simd, const K: usize> InLanes<S, Self> for U64s<S, K> {
    #[inline(always)]
    fn in_lanes(self, _simd: S) -> Self {
        self
    }
}

impl<S: Simd, const K: usize> InLanes<S, U64s<S, K>> for u64 {
    #[inline(always)]
    fn in_lanes(self, simd: S) -> U64s<S, K> {
        U64s::splat(simd, self)
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $operation:ident) => {
        impl<S: Simd, T: InLanes<S, Self>, const K: usize> $trait<T> for U64s<S, K> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: T) -> Self {
                Self(self.0, self.0.$operation(self.1, other.in_lanes(self.0).1))
            }
        }
    };
}

operator!(Add, add, u64s_add);
operator!(Sub, sub, u64s_sub);
operator!(Mul, mul, u64s_mul);
operator!(BitAnd, bitand, u64s_and);
operator!(BitOr, bitor, u64s_or);
operator!(BitXor, bitxor, u64s_xor);
