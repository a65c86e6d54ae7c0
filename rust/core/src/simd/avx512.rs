//! Lanes in a register of AVX-512 each.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use std::arch::x86_64::{__m256, __m256d, __m512d, __m512i};

use pulp::cast;
use pulp::x86::V4;

use super::Simd;
use super::registers::{bools, narrowed, pairs_of, widened};

/// The numbers of two registers of AVX2.
#[inline(always)]
fn joined(simd: V4, [lower, upper]: [__m256d; 2]) -> __m512d {
    simd.avx512f._mm512_insertf64x4::<1>(simd.avx512f._mm512_castpd256_pd512(lower), upper)
}

impl Simd for V4 {
    const HAS_FMA: bool = true;

    type F64s<const K: usize> = __m512d;
    type F32s<const K: usize> = __m256;
    type U64s<const K: usize> = __m512i;
    /// A bit for each lane; those of lanes that are not in use are arbitrary.
    type Mask<const K: usize> = u8;

    #[inline(always)]
    fn f64s<const K: usize>(self, array: [f64; K]) -> __m512d {
        cast(widened(array, 0.0))
    }

    #[inline(always)]
    fn f64_array<const K: usize>(self, a: __m512d) -> [f64; K] {
        narrowed(cast(a))
    }

    #[inline(always)]
    fn f64s_splat<const K: usize>(self, number: f64) -> __m512d {
        self.avx512f._mm512_set1_pd(number)
    }

    #[inline(always)]
    fn f64s_add<const K: usize>(self, a: __m512d, b: __m512d) -> __m512d {
        self.avx512f._mm512_add_pd(a, b)
    }

    #[inline(always)]
    fn f64s_sub<const K: usize>(self, a: __m512d, b: __m512d) -> __m512d {
        self.avx512f._mm512_sub_pd(a, b)
    }

    #[inline(always)]
    fn f64s_mul<const K: usize>(self, a: __m512d, b: __m512d) -> __m512d {
        self.avx512f._mm512_mul_pd(a, b)
    }

    #[inline(always)]
    fn f64s_div<const K: usize>(self, a: __m512d, b: __m512d) -> __m512d {
        self.avx512f._mm512_div_pd(a, b)
    }

    #[inline(always)]
    fn f64s_mul_add<const K: usize>(self, a: __m512d, b: __m512d, c: __m512d) -> __m512d {
        self.avx512f._mm512_fmadd_pd(a, b, c)
    }

    #[inline(always)]
    fn f64s_larger<const K: usize>(self, a: __m512d, b: __m512d) -> __m512d {
        self.avx512f._mm512_max_pd(a, b)
    }

    #[inline(always)]
    fn f64s_smaller<const K: usize>(self, a: __m512d, b: __m512d) -> __m512d {
        self.avx512f._mm512_min_pd(a, b)
    }

    #[inline(always)]
    fn f64s_less<const K: usize>(self, a: __m512d, b: __m512d) -> u8 {
        self.avx512f._mm512_cmplt_pd_mask(a, b)
    }

    #[inline(always)]
    fn f64s_less_or_equal<const K: usize>(self, a: __m512d, b: __m512d) -> u8 {
        self.avx512f._mm512_cmple_pd_mask(a, b)
    }

    #[inline(always)]
    fn f64s_equal<const K: usize>(self, a: __m512d, b: __m512d) -> u8 {
        self.avx512f._mm512_cmpeq_pd_mask(a, b)
    }

    #[inline(always)]
    fn f64s_select<const K: usize>(self, m: u8, yes: __m512d, no: __m512d) -> __m512d {
        self.avx512f._mm512_mask_blend_pd(m, no, yes)
    }

    #[inline(always)]
    fn f64s_to_bits<const K: usize>(self, a: __m512d) -> __m512i {
        self.avx512f._mm512_castpd_si512(a)
    }

    #[inline(always)]
    fn f64s_from_bits<const K: usize>(self, a: __m512i) -> __m512d {
        self.avx512f._mm512_castsi512_pd(a)
    }

    #[inline(always)]
    fn f64s_to_f32s<const K: usize>(self, a: __m512d) -> __m256 {
        self.avx512f._mm512_cvtpd_ps(a)
    }

    /// Pairs of columns together: a row's pair of numbers is a quarter of a register. Gathers would take longer.
    #[inline(always)]
    fn f64s_columns<const N: usize, const K: usize>(self, rows: [&[f64; N]; K]) -> [__m512d; N] {
        // Lanes that are not in use have the numbers of the first one.
        let rows = widened(rows, rows[0]);
        let mut columns = [self.avx512f._mm512_setzero_pd(); N];
        let (pairs, last) = columns.as_chunks_mut::<2>();
        for (pair, columns) in pairs.iter_mut().enumerate() {
            let even = [pairs_of(*self, pair, rows[0], rows[2]), pairs_of(*self, pair, rows[4], rows[6])];
            let odd = [pairs_of(*self, pair, rows[1], rows[3]), pairs_of(*self, pair, rows[5], rows[7])];
            let (even, odd) = (joined(self, even), joined(self, odd));
            *columns = [self.avx512f._mm512_unpacklo_pd(even, odd), self.avx512f._mm512_unpackhi_pd(even, odd)];
        }
        if let [column] = last {
            *column = cast(rows.map(|row| row[N - 1]));
        }
        columns
    }

    #[inline(always)]
    fn f32_array<const K: usize>(self, a: __m256) -> [f32; K] {
        narrowed(cast(a))
    }

    #[inline(always)]
    fn f32s_splat<const K: usize>(self, number: f32) -> __m256 {
        self.avx._mm256_set1_ps(number)
    }

    #[inline(always)]
    fn f32s_sub<const K: usize>(self, a: __m256, b: __m256) -> __m256 {
        self.avx._mm256_sub_ps(a, b)
    }

    #[inline(always)]
    fn f32s_to_f64s<const K: usize>(self, a: __m256) -> __m512d {
        self.avx512f._mm512_cvtps_pd(a)
    }

    #[inline(always)]
    fn u64s<const K: usize>(self, array: [u64; K]) -> __m512i {
        cast(widened(array, 0))
    }

    #[inline(always)]
    fn u64_array<const K: usize>(self, a: __m512i) -> [u64; K] {
        narrowed(cast(a))
    }

    #[inline(always)]
    fn u64s_splat<const K: usize>(self, number: u64) -> __m512i {
        self.avx512f._mm512_set1_epi64(number.cast_signed())
    }

    #[inline(always)]
    fn u64s_add<const K: usize>(self, a: __m512i, b: __m512i) -> __m512i {
        self.avx512f._mm512_add_epi64(a, b)
    }

    #[inline(always)]
    fn u64s_sub<const K: usize>(self, a: __m512i, b: __m512i) -> __m512i {
        self.avx512f._mm512_sub_epi64(a, b)
    }

    #[inline(always)]
    fn u64s_mul<const K: usize>(self, a: __m512i, b: __m512i) -> __m512i {
        self.avx512dq._mm512_mullo_epi64(a, b)
    }

    #[inline(always)]
    fn u64s_mul_lower<const K: usize>(self, a: __m512i, b: __m512i) -> __m512i {
        self.avx512f._mm512_mul_epu32(a, b)
    }

    #[inline(always)]
    fn u64s_and<const K: usize>(self, a: __m512i, b: __m512i) -> __m512i {
        self.avx512f._mm512_and_si512(a, b)
    }

    #[inline(always)]
    fn u64s_or<const K: usize>(self, a: __m512i, b: __m512i) -> __m512i {
        self.avx512f._mm512_or_si512(a, b)
    }

    #[inline(always)]
    fn u64s_xor<const K: usize>(self, a: __m512i, b: __m512i) -> __m512i {
        self.avx512f._mm512_xor_si512(a, b)
    }

    #[inline(always)]
    fn u64s_shift_left<const BITS: i32, const K: usize>(self, a: __m512i) -> __m512i {
        self.avx512f._mm512_sll_epi64(a, self.sse2._mm_cvtsi32_si128(BITS))
    }

    #[inline(always)]
    fn u64s_shift_right<const BITS: i32, const K: usize>(self, a: __m512i) -> __m512i {
        self.avx512f._mm512_srl_epi64(a, self.sse2._mm_cvtsi32_si128(BITS))
    }

    #[inline(always)]
    fn u64s_rotate_right<const K: usize>(self, a: __m512i, bits: __m512i) -> __m512i {
        self.avx512f._mm512_rorv_epi64(a, bits)
    }

    #[inline(always)]
    fn u64s_less<const K: usize>(self, a: __m512i, b: __m512i) -> u8 {
        self.avx512f._mm512_cmplt_epu64_mask(a, b)
    }

    #[inline(always)]
    fn u64s_increment<const K: usize>(self, m: u8, a: __m512i) -> __m512i {
        self.avx512f._mm512_mask_add_epi64(a, m, a, self.avx512f._mm512_set1_epi64(1))
    }

    #[inline(always)]
    fn u64s_equal<const K: usize>(self, a: __m512i, b: __m512i) -> u8 {
        self.avx512f._mm512_cmpeq_epi64_mask(a, b)
    }

    #[inline(always)]
    fn u64s_select<const K: usize>(self, m: u8, yes: __m512i, no: __m512i) -> __m512i {
        self.avx512f._mm512_mask_blend_epi64(m, no, yes)
    }

    #[inline(always)]
    fn mask<const K: usize>(self, array: [bool; K]) -> u8 {
        (0..K).fold(0, |bits, lane| bits | u8::from(array[lane]) << lane)
    }

    #[inline(always)]
    fn bool_array<const K: usize>(self, a: u8) -> [bool; K] {
        bools(a)
    }

    #[inline(always)]
    fn mask_and<const K: usize>(self, a: u8, b: u8) -> u8 {
        a & b
    }

    #[inline(always)]
    fn mask_or<const K: usize>(self, a: u8, b: u8) -> u8 {
        a | b
    }

    #[inline(always)]
    fn mask_xor<const K: usize>(self, a: u8, b: u8) -> u8 {
        a ^ b
    }

    #[inline(always)]
    fn mask_not<const K: usize>(self, a: u8) -> u8 {
        !a
    }

    #[inline(always)]
    fn mask_bits<const K: usize>(self, a: u8) -> u8 {
        a
    }
}
