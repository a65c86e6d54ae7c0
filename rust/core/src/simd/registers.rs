//! Conversions between arrays of up to [`LANES`] numbers and registers.

use std::arch::x86_64::{__m128d, __m256d};

use pulp::cast;
use pulp::x86::V3;

use super::LANES;

/// The number of f64 lanes of an AVX2 register.
pub(super) const WIDTH: usize = LANES / 2;

/// A result for each of two registers. If one register is enough, its result is computed twice, which the compiler
/// detects. This is a macro because the compiler may call a closure, which is not compiled for AVX2, instead of
/// inlining it.
macro_rules! both {
    ($lanes:ident, |$half:ident| $result:expr) => {
        [
            {
                let $half = 0;
                $result
            },
            {
                let $half = usize::from($lanes > $crate::simd::registers::WIDTH);
                $result
            },
        ]
    };
}

pub(super) use both;

/// An array for all lanes of the registers, with `unused` in the unused lanes.
#[inline(always)]
pub(super) fn widened<T: Copy, const K: usize>(array: [T; K], unused: T) -> [T; LANES] {
    const { assert!(K <= LANES, "there are no more lanes") };
    let mut all = [unused; LANES];
    all[..K].copy_from_slice(&array);
    all
}

/// A pair of numbers of each of two rows.
#[inline(always)]
pub(super) fn pairs_of<const N: usize>(simd: V3, pair: usize, first: &[f64; N], second: &[f64; N]) -> __m256d {
    let [first, second]: [__m128d; 2] = [cast(first.as_chunks::<2>().0[pair]), cast(second.as_chunks::<2>().0[pair])];
    simd.avx._mm256_insertf128_pd::<1>(simd.avx._mm256_castpd128_pd256(first), second)
}

/// The lanes in use.
#[inline(always)]
pub(super) fn narrowed<T: Copy, const K: usize>(all: [T; LANES]) -> [T; K] {
    const { assert!(K <= LANES, "there are no more lanes") };
    std::array::from_fn(|lane| all[lane])
}

/// The lowest bits.
#[inline(always)]
pub(super) fn bools<const K: usize>(bits: u8) -> [bool; K] {
    // The product copies the lower seven bits to every seventh position, so that bit `i` of copy `i` begins byte `i`.
    const EVERY_SEVENTH: u64 = 0x0002_0408_1020_4081;
    const LOWEST_OF_BYTES: u64 = 0x0101_0101_0101_0101;
    let spread = ((u64::from(bits & 0x7f) * EVERY_SEVENTH) & LOWEST_OF_BYTES) | (u64::from(bits >> 7) << 56);
    narrowed(spread.to_le_bytes().map(|byte| byte != 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bit_is_a_truth_value() {
        for bits in 0..=u8::MAX {
            assert_eq!(bools(bits), [0, 1, 2, 3, 4, 5, 6, 7].map(|lane| (bits >> lane) & 1 != 0));
            assert_eq!(bools(bits), [bits & 1 != 0, bits & 2 != 0]);
        }
    }
}
