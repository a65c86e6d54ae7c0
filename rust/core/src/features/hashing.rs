//! Hashed rows, for tile coding with more tiles than a table can hold.

/// A table with a fixed number of rows, shared by all tilings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct HashTable {
    pub(super) rows: u32,
}

impl HashTable {
    /// The row of a hash: `floor(hash / 2^64 * rows)`, computed from the upper 32 bits of the hash (D. Lemire, "Fast
    /// random integer generation in an interval", 2019).
    #[inline]
    pub(super) fn row(self, hash: u64) -> u32 {
        (((hash >> 32) * u64::from(self.rows)) >> 32) as u32
    }
}

/// Mixes a number into a hash: one step of `SplitMix64` applied to their sum (G. Steele, D. Lea and C. Flood, "Fast
/// splittable pseudorandom number generators", 2014, with the constants of S. Vigna's version). The first hash is 0.
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
    fn mixing_is_a_step_of_splitmix64() {
        // The first numbers of Vigna's splitmix64.c from the seeds 0 and 1234567.
        assert_eq!(mix(0, 0), 0xE220_A839_7B1D_CDAF);
        assert_eq!(mix(0, 1_234_567), 6_457_827_717_110_365_317);
    }

    #[test]
    fn hashes_map_to_the_whole_table() {
        let table = HashTable { rows: 10 };
        assert_eq!([0, u64::MAX / 2, u64::MAX].map(|hash| table.row(hash)), [0, 4, 9]);
    }
}
