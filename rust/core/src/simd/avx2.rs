//! Lanes in pairs of AVX2 registers.

use std::arch::x86_64::{__m128, __m256d, __m256i, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ};

use pulp::cast;
use pulp::x86::V3;

use super::Simd;
use super::operations::{conversions, operations};
use super::portable::all_bits;
use super::registers::{WIDTH, bools, both, narrowed, pairs_of, widened};

impl Simd for V3 {
    const HAS_FMA: bool = true;

    type F64s<const K: usize> = [__m256d; 2];
    type F32s<const K: usize> = [__m128; 2];
    type U64s<const K: usize> = [__m256i; 2];
    /// All bits of a lane set, or none.
    type Mask<const K: usize> = [__m256i; 2];

    operations! {
        self, both |half|;
        f64s_add(a: F64s, b: F64s) -> F64s = self.avx._mm256_add_pd(a[half], b[half]);
        f64s_sub(a: F64s, b: F64s) -> F64s = self.avx._mm256_sub_pd(a[half], b[half]);
        f64s_mul(a: F64s, b: F64s) -> F64s = self.avx._mm256_mul_pd(a[half], b[half]);
        f64s_div(a: F64s, b: F64s) -> F64s = self.avx._mm256_div_pd(a[half], b[half]);
        f64s_mul_add(a: F64s, b: F64s, c: F64s) -> F64s = self.fma._mm256_fmadd_pd(a[half], b[half], c[half]);
        f64s_larger(a: F64s, b: F64s) -> F64s = self.avx._mm256_max_pd(a[half], b[half]);
        f64s_smaller(a: F64s, b: F64s) -> F64s = self.avx._mm256_min_pd(a[half], b[half]);
        f64s_less(a: F64s, b: F64s) -> Mask = cast(self.avx._mm256_cmp_pd::<_CMP_LT_OQ>(a[half], b[half]));
        f64s_less_or_equal(a: F64s, b: F64s) -> Mask = cast(self.avx._mm256_cmp_pd::<_CMP_LE_OQ>(a[half], b[half]));
        f64s_equal(a: F64s, b: F64s) -> Mask = cast(self.avx._mm256_cmp_pd::<_CMP_EQ_OQ>(a[half], b[half]));
        f64s_select(m: Mask, yes: F64s, no: F64s) -> F64s = {
            self.avx._mm256_blendv_pd(no[half], yes[half], cast(m[half]))
        };
        f64s_to_f32s(a: F64s) -> F32s = self.avx._mm256_cvtpd_ps(a[half]);
        f32s_sub(a: F32s, b: F32s) -> F32s = self.sse._mm_sub_ps(a[half], b[half]);
        f32s_to_f64s(a: F32s) -> F64s = self.avx._mm256_cvtps_pd(a[half]);
        u64s_add(a: U64s, b: U64s) -> U64s = self.avx2._mm256_add_epi64(a[half], b[half]);
        u64s_sub(a: U64s, b: U64s) -> U64s = self.avx2._mm256_sub_epi64(a[half], b[half]);
        /// From products of 32-bit halves: the upper half is the sum of the lower halves of two products and the upper
        /// half of one.
        u64s_mul(a: U64s, b: U64s) -> U64s = {
            let first = self.avx2._mm256_mul_epu32(self.avx2._mm256_srli_epi64::<32>(a[half]), b[half]);
            let second = self.avx2._mm256_mul_epu32(a[half], self.avx2._mm256_srli_epi64::<32>(b[half]));
            let crossed = self.avx2._mm256_slli_epi64::<32>(self.avx2._mm256_add_epi64(first, second));
            self.avx2._mm256_add_epi64(self.avx2._mm256_mul_epu32(a[half], b[half]), crossed)
        };
        u64s_mul_lower(a: U64s, b: U64s) -> U64s = self.avx2._mm256_mul_epu32(a[half], b[half]);
        u64s_and(a: U64s, b: U64s) -> U64s = self.avx2._mm256_and_si256(a[half], b[half]);
        u64s_or(a: U64s, b: U64s) -> U64s = self.avx2._mm256_or_si256(a[half], b[half]);
        u64s_xor(a: U64s, b: U64s) -> U64s = self.avx2._mm256_xor_si256(a[half], b[half]);
        /// A shift by 64 bits gives 0.
        u64s_rotate_right(a: U64s, bits: U64s) -> U64s = {
            let others = self.avx2._mm256_sub_epi64(self.avx._mm256_set1_epi64x(64), bits[half]);
            let right = self.avx2._mm256_srlv_epi64(a[half], bits[half]);
            let left = self.avx2._mm256_sllv_epi64(a[half], others);
            self.avx2._mm256_or_si256(right, left)
        };
        /// Compares as signed integers of the same order.
        u64s_less(a: U64s, b: U64s) -> Mask = {
            let least = self.avx._mm256_set1_epi64x(i64::MIN);
            self.avx2._mm256_cmpgt_epi64(self.avx2._mm256_xor_si256(b[half], least), self.avx2._mm256_xor_si256(a[half], least))
        };
        u64s_equal(a: U64s, b: U64s) -> Mask = self.avx2._mm256_cmpeq_epi64(a[half], b[half]);
        u64s_select(m: Mask, yes: U64s, no: U64s) -> U64s = self.avx2._mm256_blendv_epi8(no[half], yes[half], m[half]);
    }

    operations! {
        self;
        f64s_to_bits(a: F64s) -> U64s = a.map(cast);
        f64s_from_bits(a: U64s) -> F64s = a.map(cast);
        mask_and(a: Mask, b: Mask) -> Mask = self.u64s_and::<K>(a, b);
        mask_or(a: Mask, b: Mask) -> Mask = self.u64s_or::<K>(a, b);
        mask_xor(a: Mask, b: Mask) -> Mask = self.u64s_xor::<K>(a, b);
        mask_not(a: Mask) -> Mask = self.u64s_xor::<K>(a, [self.avx._mm256_set1_epi64x(-1); 2]);
        /// As a number, a true mask is -1.
        u64s_increment(m: Mask, a: U64s) -> U64s = self.u64s_sub::<K>(a, m);
    }

    conversions! {
        self;
        f64s(array: [f64; K]) -> [__m256d; 2] = cast(widened(array, 0.0));
        f64_array(a: [__m256d; 2]) -> [f64; K] = narrowed(cast(a));
        f64s_splat(number: f64) -> [__m256d; 2] = [self.avx._mm256_set1_pd(number); 2];
        f32_array(a: [__m128; 2]) -> [f32; K] = narrowed(cast(a));
        f32s_splat(number: f32) -> [__m128; 2] = [self.sse._mm_set1_ps(number); 2];
        u64s(array: [u64; K]) -> [__m256i; 2] = cast(widened(array, 0));
        u64_array(a: [__m256i; 2]) -> [u64; K] = narrowed(cast(a));
        u64s_splat(number: u64) -> [__m256i; 2] = [self.avx._mm256_set1_epi64x(number.cast_signed()); 2];
        u64s_shift_left<BITS>(a: [__m256i; 2]) -> [__m256i; 2] = {
            both!(K, |half| self.avx2._mm256_slli_epi64::<BITS>(a[half]))
        };
        u64s_shift_right<BITS>(a: [__m256i; 2]) -> [__m256i; 2] = {
            both!(K, |half| self.avx2._mm256_srli_epi64::<BITS>(a[half]))
        };
        mask(array: [bool; K]) -> [__m256i; 2] = self.u64s(array.map(all_bits));
        bool_array(a: [__m256i; 2]) -> [bool; K] = bools(self.mask_bits::<K>(a));
    }

    /// Two columns at a time: a row's pair of numbers is half a register.
    #[inline(always)]
    fn f64s_columns<const N: usize, const K: usize>(self, rows: [&[f64; N]; K]) -> [[__m256d; 2]; N] {
        // Unused lanes have the numbers of the first one.
        let rows = widened(rows, rows[0]);
        let mut columns = [[self.avx._mm256_setzero_pd(); 2]; N];
        let (pairs, last) = columns.as_chunks_mut::<2>();
        for (pair, [first, second]) in pairs.iter_mut().enumerate() {
            let even = both!(K, |half| pairs_of(self, pair, rows[WIDTH * half], rows[WIDTH * half + 2]));
            let odd = both!(K, |half| pairs_of(self, pair, rows[WIDTH * half + 1], rows[WIDTH * half + 3]));
            *first = both!(K, |half| self.avx._mm256_unpacklo_pd(even[half], odd[half]));
            *second = both!(K, |half| self.avx._mm256_unpackhi_pd(even[half], odd[half]));
        }
        if let [column] = last {
            *column = cast(rows.map(|row| row[N - 1]));
        }
        columns
    }

    #[inline(always)]
    fn mask_bits<const K: usize>(self, a: [__m256i; 2]) -> u8 {
        let [lower, upper] = both!(K, |half| self.avx._mm256_movemask_pd(cast(a[half])) as u8);
        lower | (upper << WIDTH)
    }
}
