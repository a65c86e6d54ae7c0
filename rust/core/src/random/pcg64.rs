//! `numpy.random.Generator(PCG64(…))`: the stream of Gymnasium's environments and the agents' default.

use rand_core::Rng;

use super::{Draw, FLOATS, SeedSequence};

/// PCG-XSL-RR 128/64 with `NumPy`'s seeding and `NumPy`'s buffer of one 32-bit half.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pcg64 {
    engine: rand_pcg::Pcg64,
    /// The upper half of a 64-bit word whose lower half is used up; `random()` leaves it alone.
    half: Option<u32>,
    drawn: u64,
}

impl Pcg64 {
    /// `numpy.random.PCG64(seed_sequence)`.
    pub fn new(seed: &SeedSequence) -> Self {
        let [state_high, state_low, stream_high, stream_low] = seed.generate_state().map(u128::from);
        let engine = rand_pcg::Pcg64::new((state_high << 64) | state_low, (stream_high << 64) | stream_low);
        Self { engine, half: None, drawn: 0 }
    }

    /// How many 64-bit words have been drawn since seeding: what `bit_generator.advance` takes to come here.
    pub fn drawn(&self) -> u64 {
        self.drawn
    }

    /// The buffered 32-bit half, `NumPy`'s `uinteger` where its `has_uint32` is set.
    pub fn half(&self) -> Option<u32> {
        self.half
    }

    pub(crate) fn set_half(&mut self, half: Option<u32>) {
        self.half = half;
    }

    #[inline]
    pub(crate) fn next_u64(&mut self) -> u64 {
        self.drawn += 1;
        self.engine.next_u64()
    }

    #[inline]
    fn next_u32(&mut self) -> u32 {
        if let Some(half) = self.half.take() {
            return half;
        }
        let word = self.next_u64();
        self.half = Some((word >> 32) as u32);
        word as u32
    }
}

impl Draw for Pcg64 {
    #[inline]
    fn random(&mut self) -> f64 {
        unit(self.next_u64())
    }

    #[inline]
    fn fraction(&mut self) -> u64 {
        fraction(self.next_u64())
    }

    #[inline]
    fn integers(&mut self, below: u32) -> u32 {
        bounded(below, || self.next_u32())
    }
}

/// A float in [0, 1) from a word's upper 53 bits.
#[inline]
pub(crate) fn unit(word: u64) -> f64 {
    fraction(word) as f64 * (1.0 / FLOATS)
}

/// A word's upper 53 bits.
#[inline]
fn fraction(word: u64) -> u64 {
    word >> 11
}

/// Lemire's multiply-shift with rejection, as `Generator.integers` does for ranges under 2³².
#[inline]
pub(crate) fn bounded(below: u32, mut next: impl FnMut() -> u32) -> u32 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Mt19937;

    #[test]
    fn the_first_draws_of_seed_zero_are_numpys() {
        // rng = np.random.default_rng(0); rng.random(), rng.integers(0, 3), rng.random()
        let mut stream = Pcg64::new(&SeedSequence::new(&[0]));
        assert_eq!(stream.random(), 0.636_961_687_321_454_3);
        assert_eq!(stream.integers(3), 1);
        assert_eq!(stream.random(), 0.040_973_523_936_194_69);
    }

    #[test]
    fn a_fraction_is_the_float_as_a_whole_number() {
        let mut draw = Pcg64::new(&SeedSequence::new(&[0]));
        let mut other = Mt19937::new(0);
        for _ in 0..1000 {
            assert_eq!(draw.clone().fraction() as f64 / FLOATS, draw.random());
            assert_eq!(other.clone().fraction() as f64 / FLOATS, other.random());
        }
    }

    #[test]
    fn one_choice_draws_nothing() {
        let mut stream = Pcg64::new(&SeedSequence::new(&[0]));
        assert_eq!(stream.integers(1), 0);
        assert_eq!(stream.drawn(), 0);
    }
}
