//! Lanes as arrays, which the compiler may put into registers.

use super::Simd;
use super::operations::{conversions, operations};

/// The instructions that every processor of the target has.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

/// All bits set if `condition` holds, otherwise none.
#[inline(always)]
pub(super) fn all_bits(condition: bool) -> u64 {
    if condition { u64::MAX } else { 0 }
}

/// `yes` if all bits of the mask are set, `no` if none is.
#[inline(always)]
fn select(mask: u64, yes: u64, no: u64) -> u64 {
    (yes & mask) | (no & !mask)
}

/// The lower half of the bits of a u64.
const LOWER_HALF: u64 = 0xffff_ffff;

/// A result for each lane. `std::array::from_fn` is not always inlined.
macro_rules! lanes {
    ($lanes:ident, |$lane:ident| $result:expr) => {{
        let mut results = [Default::default(); $lanes];
        for ($lane, result) in results.iter_mut().enumerate() {
            *result = $result;
        }
        results
    }};
}

impl Simd for Portable {
    const HAS_FMA: bool = false;

    type F64s<const K: usize> = [f64; K];
    type F32s<const K: usize> = [f32; K];
    type U64s<const K: usize> = [u64; K];
    /// All bits of a number set, or none.
    type Mask<const K: usize> = [u64; K];

    operations! {
        self, lanes |lane|;
        f64s_add(a: F64s, b: F64s) -> F64s = a[lane] + b[lane];
        f64s_sub(a: F64s, b: F64s) -> F64s = a[lane] - b[lane];
        f64s_mul(a: F64s, b: F64s) -> F64s = a[lane] * b[lane];
        f64s_div(a: F64s, b: F64s) -> F64s = a[lane] / b[lane];
        f64s_mul_add(a: F64s, b: F64s, c: F64s) -> F64s = a[lane].mul_add(b[lane], c[lane]);
        f64s_larger(a: F64s, b: F64s) -> F64s = if a[lane] > b[lane] { a[lane] } else { b[lane] };
        f64s_smaller(a: F64s, b: F64s) -> F64s = if a[lane] < b[lane] { a[lane] } else { b[lane] };
        f64s_less(a: F64s, b: F64s) -> Mask = all_bits(a[lane] < b[lane]);
        f64s_less_or_equal(a: F64s, b: F64s) -> Mask = all_bits(a[lane] <= b[lane]);
        f64s_equal(a: F64s, b: F64s) -> Mask = all_bits(a[lane] == b[lane]);
        /// Selects by bits: without vector registers, a select between f64 would be an unpredictable branch.
        f64s_select(m: Mask, yes: F64s, no: F64s) -> F64s = {
            f64::from_bits(select(m[lane], yes[lane].to_bits(), no[lane].to_bits()))
        };
        f64s_to_bits(a: F64s) -> U64s = a[lane].to_bits();
        f64s_from_bits(a: U64s) -> F64s = f64::from_bits(a[lane]);
        f64s_to_f32s(a: F64s) -> F32s = a[lane] as f32;
        f32s_sub(a: F32s, b: F32s) -> F32s = a[lane] - b[lane];
        f32s_to_f64s(a: F32s) -> F64s = a[lane].into();
        u64s_add(a: U64s, b: U64s) -> U64s = a[lane].wrapping_add(b[lane]);
        u64s_sub(a: U64s, b: U64s) -> U64s = a[lane].wrapping_sub(b[lane]);
        u64s_mul(a: U64s, b: U64s) -> U64s = a[lane].wrapping_mul(b[lane]);
        u64s_mul_lower(a: U64s, b: U64s) -> U64s = (a[lane] & LOWER_HALF) * (b[lane] & LOWER_HALF);
        u64s_and(a: U64s, b: U64s) -> U64s = a[lane] & b[lane];
        u64s_or(a: U64s, b: U64s) -> U64s = a[lane] | b[lane];
        u64s_xor(a: U64s, b: U64s) -> U64s = a[lane] ^ b[lane];
        u64s_rotate_right(a: U64s, bits: U64s) -> U64s = a[lane].rotate_right(bits[lane] as u32);
        u64s_less(a: U64s, b: U64s) -> Mask = all_bits(a[lane] < b[lane]);
        u64s_equal(a: U64s, b: U64s) -> Mask = all_bits(a[lane] == b[lane]);
        u64s_select(m: Mask, yes: U64s, no: U64s) -> U64s = select(m[lane], yes[lane], no[lane]);
        mask_not(a: Mask) -> Mask = !a[lane];
    }

    operations! {
        self;
        mask_and(a: Mask, b: Mask) -> Mask = self.u64s_and(a, b);
        mask_or(a: Mask, b: Mask) -> Mask = self.u64s_or(a, b);
        mask_xor(a: Mask, b: Mask) -> Mask = self.u64s_xor(a, b);
        /// As a number, a true mask is -1.
        u64s_increment(m: Mask, a: U64s) -> U64s = self.u64s_sub(a, m);
    }

    conversions! {
        self;
        f64s(array: [f64; K]) -> [f64; K] = array;
        f64_array(a: [f64; K]) -> [f64; K] = a;
        f64s_splat(number: f64) -> [f64; K] = [number; K];
        f32_array(a: [f32; K]) -> [f32; K] = a;
        f32s_splat(number: f32) -> [f32; K] = [number; K];
        u64s(array: [u64; K]) -> [u64; K] = array;
        u64_array(a: [u64; K]) -> [u64; K] = a;
        u64s_splat(number: u64) -> [u64; K] = [number; K];
        u64s_shift_left<BITS>(a: [u64; K]) -> [u64; K] = lanes!(K, |lane| a[lane] << BITS);
        u64s_shift_right<BITS>(a: [u64; K]) -> [u64; K] = lanes!(K, |lane| a[lane] >> BITS);
        mask(array: [bool; K]) -> [u64; K] = lanes!(K, |lane| all_bits(array[lane]));
        bool_array(a: [u64; K]) -> [bool; K] = lanes!(K, |lane| a[lane] != 0);
        mask_bits(a: [u64; K]) -> u8 = {
            a.iter().enumerate().fold(0, |bits, (lane, mask)| bits | ((mask & 1) as u8) << lane)
        };
        mask_any(a: [u64; K]) -> bool = a.iter().fold(0, |any, bits| any | bits) != 0;
    }

    #[inline(always)]
    fn f64s_columns<const N: usize, const K: usize>(self, rows: [&[f64; N]; K]) -> [[f64; K]; N] {
        let mut columns = [[0.0; K]; N];
        for lane in 0..K {
            for (column, number) in columns.iter_mut().zip(rows[lane]) {
                column[lane] = *number;
            }
        }
        columns
    }
}
