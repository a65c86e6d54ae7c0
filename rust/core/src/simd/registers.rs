//! Arrays of up to [`LANES`] numbers as registers hold them.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::LANES;

/// An array for all lanes of the registers, zeros where a lane is not in use.
#[inline(always)]
pub(super) fn widened<T: Copy + Default, const K: usize>(array: [T; K]) -> [T; LANES] {
    const { assert!(K <= LANES, "there are no more lanes") };
    let mut all = [T::default(); LANES];
    all[..K].copy_from_slice(&array);
    all
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
    // The product copies the lower seven bits to every seventh position on, where bit `i` of copy `i` begins byte `i`.
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
