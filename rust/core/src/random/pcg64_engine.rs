//! The engine of PCG64: PCG-XSL-RR 128/64 (M. E. O'Neill, "PCG: A family of simple fast space-efficient statistically good
//! algorithms for random number generation", 2014).

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

    /// Skips so many words, modulo 2¹²⁸, in at most 128 squarings (F. B. Brown, "Random number generation with arbitrary
    /// strides", 1994).
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

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
