//! Truth values in lanes.

use std::ops::{BitAnd, BitOr, BitXor, Not};

use super::lane_type::{InLanes, lane_type};
use super::{F64s, Simd, U64s};

/// A truth value for each lane.
#[derive(Clone, Copy, Debug)]
pub struct Mask<S: Simd, const K: usize>(pub(super) S, pub(super) S::Mask<K>);

lane_type!(Mask, bool, mask, bool_array, BitAnd bitand mask_and, BitOr bitor mask_or, BitXor bitxor mask_xor);

impl<S: Simd, const K: usize> Mask<S, K> {
    /// A bit for each lane. The bits beyond are arbitrary.
    #[inline(always)]
    pub(crate) fn bits(self) -> u8 {
        self.0.mask_bits(self.1)
    }

    /// Whether the mask is true in any lane.
    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        self.0.mask_any(self.1)
    }

    /// `yes` in the lanes where the mask is true, `no` in the others.
    #[inline(always)]
    pub(crate) fn select<L: Select<S, K>>(self, yes: L, no: L) -> L {
        L::select(self, yes, no)
    }
}

/// Numbers in lanes that a mask can select.
pub(crate) trait Select<S: Simd, const K: usize> {
    fn select(mask: Mask<S, K>, yes: Self, no: Self) -> Self;
}

impl<S: Simd, const K: usize> Select<S, K> for F64s<S, K> {
    #[inline(always)]
    fn select(mask: Mask<S, K>, yes: Self, no: Self) -> Self {
        Self(mask.0, mask.0.f64s_select(mask.1, yes.1, no.1))
    }
}

impl<S: Simd, const K: usize> Select<S, K> for U64s<S, K> {
    #[inline(always)]
    fn select(mask: Mask<S, K>, yes: Self, no: Self) -> Self {
        Self(mask.0, mask.0.u64s_select(mask.1, yes.1, no.1))
    }
}

impl<S: Simd, const K: usize> Not for Mask<S, K> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(self.0, self.0.mask_not(self.1))
    }
}
