//! Lanes as arrays, which the compiler puts into registers as it can.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::Simd;

/// The instructions that every processor of the target has.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

/// All bits if `condition` holds, otherwise none.
#[inline(always)]
pub(super) fn all_bits(condition: bool) -> u64 {
    if condition { u64::MAX } else { 0 }
}

/// `yes` where a mask has all bits, `no` where it has none.
#[inline(always)]
fn select(mask: u64, yes: u64, no: u64) -> u64 {
    (yes & mask) | (no & !mask)
}

/// `f` of each lane. `std::array::from_fn` is not always inlined.
#[inline(always)]
fn lanes<T: Copy + Default, const K: usize>(f: impl Fn(usize) -> T) -> [T; K] {
    let mut results = [T::default(); K];
    for (lane, result) in results.iter_mut().enumerate() {
        *result = f(lane);
    }
    results
}

impl Simd for Portable {
    const HAS_FMA: bool = false;

    type F64s<const K: usize> = [f64; K];
    type F32s<const K: usize> = [f32; K];
    type U64s<const K: usize> = [u64; K];
    /// All bits of a number, or none.
    type Mask<const K: usize> = [u64; K];

    #[inline(always)]
    fn f64s<const K: usize>(self, array: [f64; K]) -> [f64; K] {
        array
    }

    #[inline(always)]
    fn f64_array<const K: usize>(self, a: [f64; K]) -> [f64; K] {
        a
    }

    #[inline(always)]
    fn f64s_splat<const K: usize>(self, number: f64) -> [f64; K] {
        [number; K]
    }

    #[inline(always)]
    fn f64s_add<const K: usize>(self, a: [f64; K], b: [f64; K]) -> [f64; K] {
        lanes(|lane| a[lane] + b[lane])
    }

    #[inline(always)]
    fn f64s_sub<const K: usize>(self, a: [f64; K], b: [f64; K]) -> [f64; K] {
        lanes(|lane| a[lane] - b[lane])
    }

    #[inline(always)]
    fn f64s_mul<const K: usize>(self, a: [f64; K], b: [f64; K]) -> [f64; K] {
        lanes(|lane| a[lane] * b[lane])
    }

    #[inline(always)]
    fn f64s_div<const K: usize>(self, a: [f64; K], b: [f64; K]) -> [f64; K] {
        lanes(|lane| a[lane] / b[lane])
    }

    #[inline(always)]
    fn f64s_mul_add<const K: usize>(self, a: [f64; K], b: [f64; K], c: [f64; K]) -> [f64; K] {
        lanes(|lane| a[lane].mul_add(b[lane], c[lane]))
    }

    #[inline(always)]
    fn f64s_larger<const K: usize>(self, a: [f64; K], b: [f64; K]) -> [f64; K] {
        lanes(|lane| if a[lane] > b[lane] { a[lane] } else { b[lane] })
    }

    #[inline(always)]
    fn f64s_smaller<const K: usize>(self, a: [f64; K], b: [f64; K]) -> [f64; K] {
        lanes(|lane| if a[lane] < b[lane] { a[lane] } else { b[lane] })
    }

    #[inline(always)]
    fn f64s_less<const K: usize>(self, a: [f64; K], b: [f64; K]) -> [u64; K] {
        lanes(|lane| all_bits(a[lane] < b[lane]))
    }

    #[inline(always)]
    fn f64s_less_or_equal<const K: usize>(self, a: [f64; K], b: [f64; K]) -> [u64; K] {
        lanes(|lane| all_bits(a[lane] <= b[lane]))
    }

    #[inline(always)]
    fn f64s_equal<const K: usize>(self, a: [f64; K], b: [f64; K]) -> [u64; K] {
        lanes(|lane| all_bits(a[lane] == b[lane]))
    }

    /// By bits: a select between f64 would be an unpredictable branch where there are no vector registers.
    #[inline(always)]
    fn f64s_select<const K: usize>(self, m: [u64; K], yes: [f64; K], no: [f64; K]) -> [f64; K] {
        lanes(|lane| f64::from_bits(select(m[lane], yes[lane].to_bits(), no[lane].to_bits())))
    }

    #[inline(always)]
    fn f64s_to_bits<const K: usize>(self, a: [f64; K]) -> [u64; K] {
        lanes(|lane| a[lane].to_bits())
    }

    #[inline(always)]
    fn f64s_from_bits<const K: usize>(self, a: [u64; K]) -> [f64; K] {
        lanes(|lane| f64::from_bits(a[lane]))
    }

    #[inline(always)]
    fn f64s_to_f32s<const K: usize>(self, a: [f64; K]) -> [f32; K] {
        lanes(|lane| a[lane] as f32)
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

    #[inline(always)]
    fn f32_array<const K: usize>(self, a: [f32; K]) -> [f32; K] {
        a
    }

    #[inline(always)]
    fn f32s_splat<const K: usize>(self, number: f32) -> [f32; K] {
        [number; K]
    }

    #[inline(always)]
    fn f32s_sub<const K: usize>(self, a: [f32; K], b: [f32; K]) -> [f32; K] {
        lanes(|lane| a[lane] - b[lane])
    }

    #[inline(always)]
    fn f32s_to_f64s<const K: usize>(self, a: [f32; K]) -> [f64; K] {
        lanes(|lane| a[lane].into())
    }

    #[inline(always)]
    fn u64s<const K: usize>(self, array: [u64; K]) -> [u64; K] {
        array
    }

    #[inline(always)]
    fn u64_array<const K: usize>(self, a: [u64; K]) -> [u64; K] {
        a
    }

    #[inline(always)]
    fn u64s_splat<const K: usize>(self, number: u64) -> [u64; K] {
        [number; K]
    }

    #[inline(always)]
    fn u64s_add<const K: usize>(self, a: [u64; K], b: [u64; K]) -> [u64; K] {
        lanes(|lane| a[lane].wrapping_add(b[lane]))
    }

    #[inline(always)]
    fn u64s_sub<const K: usize>(self, a: [u64; K], b: [u64; K]) -> [u64; K] {
        lanes(|lane| a[lane].wrapping_sub(b[lane]))
    }

    #[inline(always)]
    fn u64s_mul<const K: usize>(self, a: [u64; K], b: [u64; K]) -> [u64; K] {
        lanes(|lane| a[lane].wrapping_mul(b[lane]))
    }

    #[inline(always)]
    fn u64s_mul_lower<const K: usize>(self, a: [u64; K], b: [u64; K]) -> [u64; K] {
        const LOWER_HALF: u64 = 0xffff_ffff;
        lanes(|lane| (a[lane] & LOWER_HALF) * (b[lane] & LOWER_HALF))
    }

    #[inline(always)]
    fn u64s_and<const K: usize>(self, a: [u64; K], b: [u64; K]) -> [u64; K] {
        lanes(|lane| a[lane] & b[lane])
    }

    #[inline(always)]
    fn u64s_or<const K: usize>(self, a: [u64; K], b: [u64; K]) -> [u64; K] {
        lanes(|lane| a[lane] | b[lane])
    }

    #[inline(always)]
    fn u64s_xor<const K: usize>(self, a: [u64; K], b: [u64; K]) -> [u64; K] {
        lanes(|lane| a[lane] ^ b[lane])
    }

    #[inline(always)]
    fn u64s_shift_left<const BITS: i32, const K: usize>(self, a: [u64; K]) -> [u64; K] {
        lanes(|lane| a[lane] << BITS)
    }

    #[inline(always)]
    fn u64s_shift_right<const BITS: i32, const K: usize>(self, a: [u64; K]) -> [u64; K] {
        lanes(|lane| a[lane] >> BITS)
    }

    #[inline(always)]
    fn u64s_rotate_right<const K: usize>(self, a: [u64; K], bits: [u64; K]) -> [u64; K] {
        lanes(|lane| a[lane].rotate_right(bits[lane] as u32))
    }

    #[inline(always)]
    fn u64s_less<const K: usize>(self, a: [u64; K], b: [u64; K]) -> [u64; K] {
        lanes(|lane| all_bits(a[lane] < b[lane]))
    }

    #[inline(always)]
    fn u64s_increment<const K: usize>(self, m: [u64; K], a: [u64; K]) -> [u64; K] {
        // A mask is -1 as a number.
        self.u64s_sub(a, m)
    }

    #[inline(always)]
    fn u64s_equal<const K: usize>(self, a: [u64; K], b: [u64; K]) -> [u64; K] {
        lanes(|lane| all_bits(a[lane] == b[lane]))
    }

    #[inline(always)]
    fn u64s_select<const K: usize>(self, m: [u64; K], yes: [u64; K], no: [u64; K]) -> [u64; K] {
        lanes(|lane| select(m[lane], yes[lane], no[lane]))
    }

    #[inline(always)]
    fn mask<const K: usize>(self, array: [bool; K]) -> [u64; K] {
        lanes(|lane| all_bits(array[lane]))
    }

    #[inline(always)]
    fn bool_array<const K: usize>(self, a: [u64; K]) -> [bool; K] {
        lanes(|lane| a[lane] != 0)
    }

    #[inline(always)]
    fn mask_and<const K: usize>(self, a: [u64; K], b: [u64; K]) -> [u64; K] {
        self.u64s_and(a, b)
    }

    #[inline(always)]
    fn mask_or<const K: usize>(self, a: [u64; K], b: [u64; K]) -> [u64; K] {
        self.u64s_or(a, b)
    }

    #[inline(always)]
    fn mask_xor<const K: usize>(self, a: [u64; K], b: [u64; K]) -> [u64; K] {
        self.u64s_xor(a, b)
    }

    #[inline(always)]
    fn mask_not<const K: usize>(self, a: [u64; K]) -> [u64; K] {
        lanes(|lane| !a[lane])
    }

    #[inline(always)]
    fn mask_bits<const K: usize>(self, a: [u64; K]) -> u8 {
        a.iter().enumerate().fold(0, |bits, (lane, mask)| bits | ((mask & 1) as u8) << lane)
    }

    #[inline(always)]
    fn mask_any<const K: usize>(self, a: [u64; K]) -> bool {
        a.iter().fold(0, |any, bits| any | bits) != 0
    }
}
