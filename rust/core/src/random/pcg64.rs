//! `numpy.random.Generator(PCG64(…))`, the generator of Gymnasium's environments and the agents' default.
//!
//! Its engine is PCG-XSL-RR 128/64 (M. E. O'Neill, "PCG: A family of simple fast space-efficient statistically good
//! algorithms for random number generation", 2014).

use super::{Rng, SeedSequence, TWO_POW_53};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};

/// The multiplier of the congruential generator, `PCG_DEFAULT_MULTIPLIER_128`.
pub(super) const MULTIPLIER: u128 = 0x2360_ED05_1FC6_5DA4_4385_DF64_9FCC_F645;

/// A linear congruential generator modulo 2¹²⁸. Its words are a permutation of its states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pcg64Engine {
    pub(super) state: u128,
    /// Odd; it selects the sequence.
    pub(super) increment: u128,
}

impl Pcg64Engine {
    /// `pcg_setseq_128_srandom_r`. The upper bit of `stream` has no effect.
    pub(super) fn new(state: u128, stream: u128) -> Self {
        let increment = (stream << 1) | 1;
        let mut engine = Self { state: state.wrapping_add(increment), increment };
        engine.step();
        engine
    }

    #[inline]
    fn step(&mut self) {
        self.state = self.state.wrapping_mul(MULTIPLIER).wrapping_add(self.increment);
    }

    /// The next word.
    #[inline]
    pub(super) fn next_u64(&mut self) -> u64 {
        self.step();
        let (low, high) = (self.state as u64, (self.state >> 64) as u64);
        (low ^ high).rotate_right((high >> 58) as u32)
    }

    /// Skips this many words, modulo 2¹²⁸, in at most 128 squarings (F. B. Brown, "Random number generation with
    /// arbitrary strides", 1994).
    pub(super) fn advance(&mut self, words: u128) {
        let (mut multiplier, mut increment) = (MULTIPLIER, self.increment);
        let mut left = words;
        while left > 0 {
            if left & 1 == 1 {
                self.state = self.state.wrapping_mul(multiplier).wrapping_add(increment);
            }
            increment = multiplier.wrapping_add(1).wrapping_mul(increment);
            multiplier = multiplier.wrapping_mul(multiplier);
            left /= 2;
        }
    }
}

/// PCG-XSL-RR 128/64 with `NumPy`'s seeding and its buffer of one 32-bit half.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pcg64 {
    pub(super) engine: Pcg64Engine,
    /// The upper half of a 64-bit word whose lower half has been used. `random()` does not touch it.
    pub(super) buffered_u32: Option<u32>,
    pub(super) words_drawn: u64,
}

impl Pcg64 {
    /// `numpy.random.PCG64(seed_sequence)`.
    pub fn new(seed: &SeedSequence) -> Self {
        let [state_high, state_low, stream_high, stream_low] = seed.generate_state().map(u128::from);
        let engine = Pcg64Engine::new((state_high << 64) | state_low, (stream_high << 64) | stream_low);
        Self { engine, buffered_u32: None, words_drawn: 0 }
    }

    /// The number of 64-bit words drawn since seeding: `bit_generator.advance(words_drawn)` restores this state.
    pub fn words_drawn(&self) -> u64 {
        self.words_drawn
    }

    /// The buffered 32-bit half: `NumPy`'s `uinteger` if `has_uint32` is set.
    pub fn buffered_u32(&self) -> Option<u32> {
        self.buffered_u32
    }

    /// Moves to the position after `words_drawn` words, with this buffered half.
    pub fn move_to(&mut self, words_drawn: u64, buffered_u32: Option<u32>) {
        self.engine.advance(u128::from(words_drawn).wrapping_sub(u128::from(self.words_drawn)));
        self.words_drawn = words_drawn;
        self.buffered_u32 = buffered_u32;
    }

    /// The next word: `bit_generator.random_raw()`.
    #[inline]
    pub fn next_u64(&mut self) -> u64 {
        self.words_drawn += 1;
        self.engine.next_u64()
    }

    /// The next 32 bits: the lower half of a word, then its upper half.
    #[inline]
    pub fn next_u32(&mut self) -> u32 {
        if let Some(buffered_u32) = self.buffered_u32.take() {
            return buffered_u32;
        }
        let word = self.next_u64();
        self.buffered_u32 = Some((word >> 32) as u32);
        word as u32
    }
}

impl Rng for Pcg64 {
    #[inline]
    fn random(&mut self) -> f64 {
        u64_to_f64(self.next_u64())
    }

    #[inline]
    fn random_u53(&mut self) -> u64 {
        upper_53_bits(self.next_u64())
    }

    #[inline]
    fn integers(&mut self, below: u32) -> u32 {
        lemire_bounded(below, || self.next_u32())
    }

    /// The first word of the generator.
    fn seed_fingerprint(&self) -> Option<u64> {
        let mut first = self.engine;
        first.advance(u128::from(self.words_drawn).wrapping_neg());
        Some(first.next_u64())
    }
}

/// A float in [0, 1) from the upper 53 bits of a word.
#[inline]
pub(crate) fn u64_to_f64(word: u64) -> f64 {
    upper_53_bits(word) as f64 * (1.0 / TWO_POW_53)
}

/// The upper 53 bits of a word.
#[inline]
fn upper_53_bits(word: u64) -> u64 {
    word >> 11
}

/// An unbiased integer in [0, `below`), by multiplication and rejection, as `Generator.integers` does for ranges below
/// 2³² (D. Lemire, "Fast random integer generation in an interval", 2019).
#[inline]
pub(crate) fn lemire_bounded(below: u32, mut next: impl FnMut() -> u32) -> u32 {
    if below <= 1 {
        return 0;
    }
    let mut product = u64::from(next()) * u64::from(below);
    if (product as u32) < below {
        let threshold = below.wrapping_neg() % below;
        while (product as u32) < threshold {
            product = u64::from(next()) * u64::from(below);
        }
    }
    (product >> 32) as u32
}

/// The position, to which a generator of the same seed is advanced.
impl Persist for Pcg64 {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let (mut words_drawn, mut buffered_u32) = (self.words_drawn, self.buffered_u32);
        (&mut words_drawn, &mut buffered_u32).persist(checkpoint)?;
        self.move_to(words_drawn, buffered_u32);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    // Not the whole prelude: its `RngExt` has a method `random` too.
    use proptest::prelude::{any, prop_assert_eq, proptest};

    use super::*;
    use crate::random::{Mt19937, Rng};

    #[test]
    fn the_first_draws_of_seed_0_match_numpy() {
        // rng = np.random.default_rng(0); rng.random(), rng.integers(0, 3), rng.random()
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        assert_eq!(rng.random(), 0.636_961_687_321_454_3);
        assert_eq!(rng.integers(3), 1);
        assert_eq!(rng.random(), 0.040_973_523_936_194_69);
    }

    #[test]
    fn random_u53_is_random_as_an_integer() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let mut other = Mt19937::new(0);
        for _ in 0..1000 {
            assert_eq!(rng.clone().random_u53() as f64 / TWO_POW_53, rng.random());
            assert_eq!(other.clone().random_u53() as f64 / TWO_POW_53, other.random());
        }
    }

    #[test]
    fn the_fingerprint_depends_on_the_seed_alone() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let first = rng.seed_fingerprint();
        rng.next_u64();
        rng.next_u32();
        assert_eq!(rng.seed_fingerprint(), first);
        assert_ne!(Pcg64::new(&SeedSequence::new(&[1])).seed_fingerprint(), first);
    }

    #[test]
    fn a_range_of_one_integer_draws_nothing() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        assert_eq!(rng.integers(1), 0);
        assert_eq!(rng.words_drawn(), 0);
    }

    proptest! {
        #[test]
        fn skipping_words_is_drawing_them(
            state in any::<u128>(), stream in any::<u128>(), words in 0_u64..200, further in any::<u128>(),
        ) {
            let mut drawn = Pcg64Engine::new(state, stream);
            let mut skipped = drawn;
            for _ in 0..words {
                drawn.next_u64();
            }
            skipped.advance(words.into());
            prop_assert_eq!(drawn, skipped);
            skipped.advance(further);
            skipped.advance(further.wrapping_neg());
            prop_assert_eq!(drawn, skipped);
        }
    }
}
