//! The trait of instruction sets.

#![expect(missing_docs, reason = "the methods are named after their operations")]
use std::fmt::Debug;

use super::LANES;

/// The operations of an instruction set on numbers in `K` lanes. A value proves that this processor has the instruction
/// set.
///
/// Comparisons with NaN are false. `larger` is `if a > b { a } else { b }`, and `smaller` is `if a < b { a } else { b }`.
pub trait Simd: Copy + Debug {
    /// Whether `mul_add` is one instruction. Otherwise it can be a slow function of the C library.
    const HAS_FMA: bool;

    /// One or more registers of f64.
    type F64s<const K: usize>: Copy + Debug;
    /// One or more registers of f32.
    type F32s<const K: usize>: Copy + Debug;
    /// One or more registers of u64.
    type U64s<const K: usize>: Copy + Debug;
    /// One or more registers of truth values.
    type Mask<const K: usize>: Copy + Debug;

    fn f64s<const K: usize>(self, array: [f64; K]) -> Self::F64s<K>;
    fn f64_array<const K: usize>(self, a: Self::F64s<K>) -> [f64; K];
    fn f64s_splat<const K: usize>(self, number: f64) -> Self::F64s<K>;
    fn f64s_add<const K: usize>(self, a: Self::F64s<K>, b: Self::F64s<K>) -> Self::F64s<K>;
    fn f64s_sub<const K: usize>(self, a: Self::F64s<K>, b: Self::F64s<K>) -> Self::F64s<K>;
    fn f64s_mul<const K: usize>(self, a: Self::F64s<K>, b: Self::F64s<K>) -> Self::F64s<K>;
    fn f64s_div<const K: usize>(self, a: Self::F64s<K>, b: Self::F64s<K>) -> Self::F64s<K>;
    fn f64s_mul_add<const K: usize>(self, a: Self::F64s<K>, b: Self::F64s<K>, c: Self::F64s<K>) -> Self::F64s<K>;
    fn f64s_larger<const K: usize>(self, a: Self::F64s<K>, b: Self::F64s<K>) -> Self::F64s<K>;
    fn f64s_smaller<const K: usize>(self, a: Self::F64s<K>, b: Self::F64s<K>) -> Self::F64s<K>;
    fn f64s_less<const K: usize>(self, a: Self::F64s<K>, b: Self::F64s<K>) -> Self::Mask<K>;
    fn f64s_less_or_equal<const K: usize>(self, a: Self::F64s<K>, b: Self::F64s<K>) -> Self::Mask<K>;
    fn f64s_equal<const K: usize>(self, a: Self::F64s<K>, b: Self::F64s<K>) -> Self::Mask<K>;
    fn f64s_select<const K: usize>(self, m: Self::Mask<K>, yes: Self::F64s<K>, no: Self::F64s<K>) -> Self::F64s<K>;
    fn f64s_to_bits<const K: usize>(self, a: Self::F64s<K>) -> Self::U64s<K>;
    fn f64s_from_bits<const K: usize>(self, a: Self::U64s<K>) -> Self::F64s<K>;
    fn f64s_to_f32s<const K: usize>(self, a: Self::F64s<K>) -> Self::F32s<K>;
    /// The columns of a matrix whose rows may lie anywhere in memory.
    fn f64s_columns<const N: usize, const K: usize>(self, rows: [&[f64; N]; K]) -> [Self::F64s<K>; N];

    fn f32_array<const K: usize>(self, a: Self::F32s<K>) -> [f32; K];
    fn f32s_splat<const K: usize>(self, number: f32) -> Self::F32s<K>;
    fn f32s_sub<const K: usize>(self, a: Self::F32s<K>, b: Self::F32s<K>) -> Self::F32s<K>;
    fn f32s_to_f64s<const K: usize>(self, a: Self::F32s<K>) -> Self::F64s<K>;

    fn u64s<const K: usize>(self, array: [u64; K]) -> Self::U64s<K>;
    fn u64_array<const K: usize>(self, a: Self::U64s<K>) -> [u64; K];
    fn u64s_splat<const K: usize>(self, number: u64) -> Self::U64s<K>;
    fn u64s_add<const K: usize>(self, a: Self::U64s<K>, b: Self::U64s<K>) -> Self::U64s<K>;
    fn u64s_sub<const K: usize>(self, a: Self::U64s<K>, b: Self::U64s<K>) -> Self::U64s<K>;
    fn u64s_mul<const K: usize>(self, a: Self::U64s<K>, b: Self::U64s<K>) -> Self::U64s<K>;
    /// The products of the lower halves.
    fn u64s_mul_lower<const K: usize>(self, a: Self::U64s<K>, b: Self::U64s<K>) -> Self::U64s<K>;
    fn u64s_and<const K: usize>(self, a: Self::U64s<K>, b: Self::U64s<K>) -> Self::U64s<K>;
    fn u64s_or<const K: usize>(self, a: Self::U64s<K>, b: Self::U64s<K>) -> Self::U64s<K>;
    fn u64s_xor<const K: usize>(self, a: Self::U64s<K>, b: Self::U64s<K>) -> Self::U64s<K>;
    fn u64s_shift_left<const BITS: i32, const K: usize>(self, a: Self::U64s<K>) -> Self::U64s<K>;
    fn u64s_shift_right<const BITS: i32, const K: usize>(self, a: Self::U64s<K>) -> Self::U64s<K>;
    fn u64s_rotate_right<const K: usize>(self, a: Self::U64s<K>, bits: Self::U64s<K>) -> Self::U64s<K>;
    fn u64s_less<const K: usize>(self, a: Self::U64s<K>, b: Self::U64s<K>) -> Self::Mask<K>;
    /// Adds one where the mask is true.
    fn u64s_increment<const K: usize>(self, m: Self::Mask<K>, a: Self::U64s<K>) -> Self::U64s<K>;
    fn u64s_equal<const K: usize>(self, a: Self::U64s<K>, b: Self::U64s<K>) -> Self::Mask<K>;
    fn u64s_select<const K: usize>(self, m: Self::Mask<K>, yes: Self::U64s<K>, no: Self::U64s<K>) -> Self::U64s<K>;

    fn mask<const K: usize>(self, array: [bool; K]) -> Self::Mask<K>;
    fn bool_array<const K: usize>(self, a: Self::Mask<K>) -> [bool; K];
    fn mask_and<const K: usize>(self, a: Self::Mask<K>, b: Self::Mask<K>) -> Self::Mask<K>;
    fn mask_or<const K: usize>(self, a: Self::Mask<K>, b: Self::Mask<K>) -> Self::Mask<K>;
    fn mask_xor<const K: usize>(self, a: Self::Mask<K>, b: Self::Mask<K>) -> Self::Mask<K>;
    fn mask_not<const K: usize>(self, a: Self::Mask<K>) -> Self::Mask<K>;
    /// A bit for each lane. The bits beyond are arbitrary.
    fn mask_bits<const K: usize>(self, a: Self::Mask<K>) -> u8;
    #[inline(always)]
    fn mask_any<const K: usize>(self, a: Self::Mask<K>) -> bool {
        // The shift drops the bits beyond the lanes.
        self.mask_bits::<K>(a) << (LANES - K) != 0
    }
}
