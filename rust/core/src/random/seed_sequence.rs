//! `numpy.random.SeedSequence`, which mixes any amount of entropy into seed words.
//!
//! Source: `numpy/random/bit_generator.pyx`, which follows M. E. O'Neill's `seed_seq_fe`.

const POOL_SIZE: usize = 4;
const XSHIFT: u32 = 16;
const INIT_A: u32 = 0x43b0_d7e5;
const MULT_A: u32 = 0x931e_8875;
const INIT_B: u32 = 0x8b51_f9dd;
const MULT_B: u32 = 0x58f3_8ded;
const MIX_MULT_L: u32 = 0xca01_f9dd;
const MIX_MULT_R: u32 = 0x4973_f715;

/// `numpy.random.SeedSequence(entropy)`, or a child spawned from one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SeedSequence {
    entropy: Vec<u32>,
    spawn_key: Vec<u32>,
    pool: [u32; POOL_SIZE],
}

/// `numpy.random.SeedSequence(seed)`.
impl From<u64> for SeedSequence {
    fn from(seed: u64) -> Self {
        let words = [seed as u32, (seed >> 32) as u32];
        Self::new(if words[1] == 0 { &words[..1] } else { &words })
    }
}

impl SeedSequence {
    /// The sequence of a non-negative integer, given as 32-bit words with the least significant first. Zero is one word.
    pub fn new(entropy: &[u32]) -> Self {
        Self::with_spawn_key(entropy.to_vec(), Vec::new())
    }

    /// Child `index` of this sequence: `SeedSequence(seed).spawn(index + 1)[index]`.
    #[must_use]
    pub fn child(&self, index: u32) -> Self {
        let mut spawn_key = self.spawn_key.clone();
        spawn_key.push(index);
        Self::with_spawn_key(self.entropy.clone(), spawn_key)
    }

    fn with_spawn_key(entropy: Vec<u32>, spawn_key: Vec<u32>) -> Self {
        let mut assembled = entropy.clone();
        if !spawn_key.is_empty() && assembled.len() < POOL_SIZE {
            // NumPy pads short entropy, so that with a spawn key it never equals longer entropy without one.
            assembled.resize(POOL_SIZE, 0);
        }
        assembled.extend(&spawn_key);
        let pool = mix_entropy(&assembled);
        Self { entropy, spawn_key, pool }
    }

    /// `generate_state(N, numpy.uint64)`.
    pub fn generate_state<const N: usize>(&self) -> [u64; N] {
        let mut hash = INIT_B;
        let mut source = self.pool.iter().cycle();
        let mut word = || {
            let mut value = *source.next().unwrap_or(&0) ^ hash;
            hash = hash.wrapping_mul(MULT_B);
            value = value.wrapping_mul(hash);
            u64::from(value ^ (value >> XSHIFT))
        };
        std::array::from_fn(|_| word() | (word() << 32))
    }
}

fn mix_entropy(entropy: &[u32]) -> [u32; POOL_SIZE] {
    let mut hash = INIT_A;
    let mut hashed = |mut value: u32| {
        value ^= hash;
        hash = hash.wrapping_mul(MULT_A);
        value = value.wrapping_mul(hash);
        value ^ (value >> XSHIFT)
    };
    let mut pool: [u32; POOL_SIZE] = std::array::from_fn(|i| hashed(entropy.get(i).copied().unwrap_or(0)));
    for source in 0..POOL_SIZE {
        for target in 0..POOL_SIZE {
            if source != target {
                pool[target] = mix(pool[target], hashed(pool[source]));
            }
        }
    }
    for &word in entropy.iter().skip(POOL_SIZE) {
        for value in &mut pool {
            *value = mix(*value, hashed(word));
        }
    }
    pool
}

fn mix(x: u32, y: u32) -> u32 {
    let mixed = MIX_MULT_L.wrapping_mul(x).wrapping_sub(MIX_MULT_R.wrapping_mul(y));
    mixed ^ (mixed >> XSHIFT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_of_seed_0_match_numpy() {
        // np.random.SeedSequence(0).generate_state(2, np.uint64)
        assert_eq!(SeedSequence::new(&[0]).generate_state(), [15_793_235_383_387_715_774, 12_390_638_538_380_655_177]);
    }

    #[test]
    fn a_seed_of_64_bits_is_two_words() {
        assert_eq!(SeedSequence::from(0), SeedSequence::new(&[0]));
        assert_eq!(SeedSequence::from((7 << 32) | 5), SeedSequence::new(&[5, 7]));
    }

    #[test]
    fn children_differ_from_their_parent_and_from_each_other() {
        let parent = SeedSequence::new(&[7]);
        let words = [&parent, &parent.child(0), &parent.child(1)].map(SeedSequence::generate_state::<2>);
        assert_ne!(words[0], words[1]);
        assert_ne!(words[1], words[2]);
    }
}
