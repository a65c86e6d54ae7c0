//! Lanes in single AVX-512 registers.

use std::arch::x86_64::{__m256, __m256d, __m512d, __m512i};

use pulp::cast;
use pulp::x86::V4;

use super::Simd;
use super::operations::{conversions, operations};
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
    /// A bit for each lane; those of unused lanes are arbitrary.
    type Mask<const K: usize> = u8;

    operations! {
        self;
        f64s_add(a: F64s, b: F64s) -> F64s = self.avx512f._mm512_add_pd(a, b);
        f64s_sub(a: F64s, b: F64s) -> F64s = self.avx512f._mm512_sub_pd(a, b);
        f64s_mul(a: F64s, b: F64s) -> F64s = self.avx512f._mm512_mul_pd(a, b);
        f64s_div(a: F64s, b: F64s) -> F64s = self.avx512f._mm512_div_pd(a, b);
        f64s_mul_add(a: F64s, b: F64s, c: F64s) -> F64s = self.avx512f._mm512_fmadd_pd(a, b, c);
        f64s_larger(a: F64s, b: F64s) -> F64s = self.avx512f._mm512_max_pd(a, b);
        f64s_smaller(a: F64s, b: F64s) -> F64s = self.avx512f._mm512_min_pd(a, b);
        f64s_less(a: F64s, b: F64s) -> Mask = self.avx512f._mm512_cmplt_pd_mask(a, b);
        f64s_less_or_equal(a: F64s, b: F64s) -> Mask = self.avx512f._mm512_cmple_pd_mask(a, b);
        f64s_equal(a: F64s, b: F64s) -> Mask = self.avx512f._mm512_cmpeq_pd_mask(a, b);
        f64s_select(m: Mask, yes: F64s, no: F64s) -> F64s = self.avx512f._mm512_mask_blend_pd(m, no, yes);
        f64s_to_bits(a: F64s) -> U64s = self.avx512f._mm512_castpd_si512(a);
        f64s_from_bits(a: U64s) -> F64s = self.avx512f._mm512_castsi512_pd(a);
        f64s_to_f32s(a: F64s) -> F32s = self.avx512f._mm512_cvtpd_ps(a);
        f32s_sub(a: F32s, b: F32s) -> F32s = self.avx._mm256_sub_ps(a, b);
        f32s_to_f64s(a: F32s) -> F64s = self.avx512f._mm512_cvtps_pd(a);
        u64s_add(a: U64s, b: U64s) -> U64s = self.avx512f._mm512_add_epi64(a, b);
        u64s_sub(a: U64s, b: U64s) -> U64s = self.avx512f._mm512_sub_epi64(a, b);
        u64s_mul(a: U64s, b: U64s) -> U64s = self.avx512dq._mm512_mullo_epi64(a, b);
        u64s_mul_lower(a: U64s, b: U64s) -> U64s = self.avx512f._mm512_mul_epu32(a, b);
        u64s_and(a: U64s, b: U64s) -> U64s = self.avx512f._mm512_and_si512(a, b);
        u64s_or(a: U64s, b: U64s) -> U64s = self.avx512f._mm512_or_si512(a, b);
        u64s_xor(a: U64s, b: U64s) -> U64s = self.avx512f._mm512_xor_si512(a, b);
        u64s_rotate_right(a: U64s, bits: U64s) -> U64s = self.avx512f._mm512_rorv_epi64(a, bits);
        u64s_less(a: U64s, b: U64s) -> Mask = self.avx512f._mm512_cmplt_epu64_mask(a, b);
        u64s_increment(m: Mask, a: U64s) -> U64s = {
            self.avx512f._mm512_mask_add_epi64(a, m, a, self.avx512f._mm512_set1_epi64(1))
        };
        u64s_equal(a: U64s, b: U64s) -> Mask = self.avx512f._mm512_cmpeq_epi64_mask(a, b);
        u64s_select(m: Mask, yes: U64s, no: U64s) -> U64s = self.avx512f._mm512_mask_blend_epi64(m, no, yes);
        mask_and(a: Mask, b: Mask) -> Mask = a & b;
        mask_or(a: Mask, b: Mask) -> Mask = a | b;
        mask_xor(a: Mask, b: Mask) -> Mask = a ^ b;
        mask_not(a: Mask) -> Mask = !a;
    }

    conversions! {
        self;
        f64s(array: [f64; K]) -> __m512d = cast(widened(array, 0.0));
        f64_array(a: __m512d) -> [f64; K] = narrowed(cast(a));
        f64s_splat(number: f64) -> __m512d = self.avx512f._mm512_set1_pd(number);
        f32_array(a: __m256) -> [f32; K] = narrowed(cast(a));
        f32s_splat(number: f32) -> __m256 = self.avx._mm256_set1_ps(number);
        u64s(array: [u64; K]) -> __m512i = cast(widened(array, 0));
        u64_array(a: __m512i) -> [u64; K] = narrowed(cast(a));
        u64s_splat(number: u64) -> __m512i = self.avx512f._mm512_set1_epi64(number.cast_signed());
        u64s_shift_left<BITS>(a: __m512i) -> __m512i = {
            self.avx512f._mm512_sll_epi64(a, self.sse2._mm_cvtsi32_si128(BITS))
        };
        u64s_shift_right<BITS>(a: __m512i) -> __m512i = {
            self.avx512f._mm512_srl_epi64(a, self.sse2._mm_cvtsi32_si128(BITS))
        };
        mask(array: [bool; K]) -> u8 = (0..K).fold(0, |bits, lane| bits | u8::from(array[lane]) << lane);
        bool_array(a: u8) -> [bool; K] = bools(a);
        mask_bits(a: u8) -> u8 = a;
    }

    /// Two columns at a time: a row's pair of numbers is a quarter of a register. Gathers would take longer.
    #[inline(always)]
    fn f64s_columns<const N: usize, const K: usize>(self, rows: [&[f64; N]; K]) -> [__m512d; N] {
        // Unused lanes have the numbers of the first one.
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
}
