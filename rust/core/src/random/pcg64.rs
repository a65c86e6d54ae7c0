//! `numpy.random.Generator(PCG64(…))`, the generator of Gymnasium's environments and the agents' default.

use super::pcg64_engine::Pcg64Engine;
use super::{Rng, SeedSequence, TWO_POW_53};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};

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

    #[inline]
    pub(crate) fn next_u64(&mut self) -> u64 {
        self.words_drawn += 1;
        self.engine.next_u64()
    }

    #[inline]
    fn next_u32(&mut self) -> u32 {
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

/// The position: a generator of the same seed is advanced to it.
impl Persist for Pcg64 {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let mut words_drawn = self.words_drawn;
        (&mut words_drawn, &mut self.buffered_u32).persist(checkpoint)?;
        self.engine.advance(u128::from(words_drawn).wrapping_sub(u128::from(self.words_drawn)));
        self.words_drawn = words_drawn;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Mt19937;

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
    fn a_range_of_one_integer_draws_nothing() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        assert_eq!(rng.integers(1), 0);
        assert_eq!(rng.words_drawn(), 0);
    }
}
