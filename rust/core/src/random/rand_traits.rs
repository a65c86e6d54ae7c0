//! The traits of the `rand` crates: generators of one kind where the other is expected.

use std::convert::Infallible;

use rand_core::{SeedableRng, TryRng};

use super::pcg64::{Pcg64Engine, lemire_bounded, u64_to_f64};
use super::{Pcg64, Rng, SeedSequence};

/// The words of the generator, as `rand` and the crates around it draw them. 32-bit words are the halves of a 64-bit word,
/// the lower one first, as in `NumPy`.
impl TryRng for Pcg64 {
    type Error = Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.next_u32())
    }

    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(self.next_u64())
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        rand_core::utils::fill_bytes_via_next_word(bytes, || Ok(self.next_u64()))
    }
}

impl SeedableRng for Pcg64 {
    type Seed = [u8; 32];

    /// The state and the stream of the generator, from 16 bytes each, with the least significant first.
    fn from_seed(seed: [u8; 32]) -> Self {
        let [state, state_high, stream, stream_high] = rand_core::utils::read_words::<u64, 4>(&seed).map(u128::from);
        let engine = Pcg64Engine::new(state | (state_high << 64), stream | (stream_high << 64));
        Self { engine, buffered_u32: None, words_drawn: 0 }
    }

    /// `numpy.random.default_rng(seed)`.
    fn seed_from_u64(seed: u64) -> Self {
        Self::new(&SeedSequence::from(seed))
    }
}

/// A generator of the `rand` crates where this crate expects one. Floats and integers are made from its words as `NumPy`
/// makes them from those of PCG64. A [`Trainer`](crate::Trainer) needs a generator that is `Clone`, such as `SmallRng`;
/// `StdRng` is not.
///
/// ```
/// use qtab_core::random::{FromRand, Pcg64, Rng};
/// use qtab_core::rand_core::SeedableRng;
///
/// // Any generator with `rand_core::Rng`.
/// let mut rng = FromRand(Pcg64::seed_from_u64(7));
/// assert!(rng.integers(6) < 6);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FromRand<G>(pub G);

impl<G: rand_core::Rng> Rng for FromRand<G> {
    #[inline]
    fn random(&mut self) -> f64 {
        u64_to_f64(self.0.next_u64())
    }

    #[inline]
    fn integers(&mut self, below: u32) -> u32 {
        lemire_bounded(below, || self.0.next_u32())
    }
}

/// A generator of this crate, such as [`Env::step`](crate::Env::step) receives, where the `rand` crates expect one: for
/// distributions that this crate lacks.
///
/// ```
/// use qtab_core::random::{AsRand, NoRng, Rng};
/// use qtab_core::rand_core;
///
/// fn roll(rng: &mut impl Rng) -> u64 {
///     rand_core::Rng::next_u64(&mut AsRand(rng)) % 6
/// }
/// assert_eq!(roll(&mut NoRng), 0);
/// ```
#[derive(Debug)]
pub struct AsRand<'a, R: ?Sized>(pub &'a mut R);

impl<R: Rng + ?Sized> AsRand<'_, R> {
    /// The upper 32 of the 53 bits of a draw.
    #[inline]
    fn word(&mut self) -> u32 {
        (self.0.random_u53() >> 21) as u32
    }
}

impl<R: Rng + ?Sized> TryRng for AsRand<'_, R> {
    type Error = Infallible;

    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.word())
    }

    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        rand_core::utils::next_u64_via_u32(self)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        rand_core::utils::fill_bytes_via_next_word(bytes, || self.try_next_u32())
    }
}

#[cfg(test)]
mod tests {
    use rand_core::Rng as _;

    use super::*;

    #[test]
    fn the_words_of_default_rng_match_numpy() {
        // np.random.default_rng(7).bit_generator.random_raw()
        assert_eq!(Pcg64::seed_from_u64(7), Pcg64::new(&SeedSequence::from(7)));
        let mut rng = Pcg64::seed_from_u64(7);
        let word = rng.clone().next_u64();
        assert_eq!([rng.next_u32(), rng.next_u32()], [word as u32, (word >> 32) as u32]);
        assert_eq!(rng.words_drawn(), 1);
    }

    #[test]
    fn a_wrapped_generator_draws_the_same_numbers() {
        let (mut rng, mut wrapped) = (Pcg64::seed_from_u64(1), FromRand(Pcg64::seed_from_u64(1)));
        for below in [2, 3, 1000] {
            assert_eq!(rng.random(), wrapped.random());
            assert_eq!(rng.integers(below), wrapped.integers(below));
        }
    }

    #[test]
    fn a_seed_is_the_state_and_the_stream() {
        let mut seed = [0; 32];
        (seed[0], seed[16]) = (42, 54);
        assert_eq!(Pcg64::from_seed(seed).engine, Pcg64Engine::new(42, 54));
    }

    #[test]
    fn words_are_made_of_the_upper_bits_of_draws() {
        let mut rng = Pcg64::seed_from_u64(3);
        let first = rng.clone().next_u64();
        assert_eq!(u64::from(AsRand(&mut rng).next_u32()), first >> 32);
        let mut bytes = [0; 6];
        AsRand(&mut rng).fill_bytes(&mut bytes);
        assert_eq!(rng.words_drawn(), 3);
    }
}
