//! A table of any size for what has too many rows: where a row would be is told by a hash of its coordinates.

/// A table of so many rows, shared by all tilings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Hashed {
    pub(super) rows: u32,
}

impl Hashed {
    /// The row of a hash: `floor(hash / 2^64 * rows)`, as far as the upper half of the hash tells (D. Lemire, "Fast
    /// random integer generation in an interval", 2019).
    #[inline]
    pub(super) fn row(self, hash: u64) -> u32 {
        (((hash >> 32) * u64::from(self.rows)) >> 32) as u32
    }
}

/// One number more into a hash that begins with 0: a step of `SplitMix64` from the sum of both (G. Steele, D. Lea and
/// C. Flood, "Fast splittable pseudorandom number generators", 2014, with the constants of Vigna's version).
#[inline]
pub(super) fn mix(hash: u64, number: u32) -> u64 {
    let mut hash = hash.wrapping_add(u64::from(number)).wrapping_add(0x9E37_79B9_7F4A_7C15);
    hash = (hash ^ (hash >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    hash = (hash ^ (hash >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    hash ^ (hash >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stir_is_a_step_of_splitmix64() {
        // The first numbers of Vigna's splitmix64.c from the seeds 0 and 1234567.
        assert_eq!(mix(0, 0), 0xE220_A839_7B1D_CDAF);
        assert_eq!(mix(0, 1_234_567), 6_457_827_717_110_365_317);
    }

    #[test]
    fn the_rows_are_spread_over_the_whole_table() {
        let table = Hashed { rows: 10 };
        assert_eq!([0, u64::MAX / 2, u64::MAX].map(|hash| table.row(hash)), [0, 4, 9]);
    }
}
