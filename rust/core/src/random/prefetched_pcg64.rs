//! A PCG64 that draws its words in advance, so that exploring or not needs no branch.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]
#![expect(clippy::needless_bitwise_bool, reason = "a lazy operator would be an unpredictable branch")]

use super::pcg64::{lemire_bounded, u64_to_f64};
use super::{Pcg64, Rng};
use crate::numeric::cold_path;

/// The number of words drawn in advance.
const CAPACITY: usize = 64;

/// A [`Pcg64`] with a buffer of its next words. Its draws are those of the [`Pcg64`].
pub(crate) struct PrefetchedPcg64 {
    /// The generator before the first buffered word.
    start: Pcg64,
    /// The generator after the last buffered word.
    end: Pcg64,
    words: [u64; CAPACITY],
    /// The number of buffered words used.
    used: usize,
    buffered_u32: u32,
    has_uint32: bool,
}

impl PrefetchedPcg64 {
    /// Continues the draws of `rng`.
    pub(crate) fn new(rng: &Pcg64) -> Self {
        let buffered_u32 = rng.buffered_u32();
        let mut end = rng.clone();
        let words = std::array::from_fn(|_| end.next_u64());
        Self {
            start: rng.clone(),
            end,
            words,
            used: 0,
            buffered_u32: buffered_u32.unwrap_or(0),
            has_uint32: buffered_u32.is_some(),
        }
    }

    /// The generator after the draws made so far.
    pub(crate) fn into_pcg64(self) -> Pcg64 {
        let mut rng = self.start;
        for _ in 0..self.used {
            rng.next_u64();
        }
        rng.set_buffered_u32(self.has_uint32.then_some(self.buffered_u32));
        rng
    }

    /// An ε-greedy decision: whether `random()` is at least `greedy_below` (explore), and if so `integers(below)`, which
    /// is drawn only then. `below` must be greater than 1.
    #[inline(always)]
    pub(crate) fn explore(&mut self, greedy_below: f64, below: u32) -> (bool, u32) {
        if self.used + 2 > CAPACITY {
            self.refill();
        }
        let explores = u64_to_f64(self.words[self.used]) >= greedy_below;
        let word = self.words[self.used + 1];
        let buffered_u32 = std::hint::select_unpredictable(self.has_uint32, self.buffered_u32, word as u32);
        let product = u64::from(buffered_u32) * u64::from(below);
        if (product as u32) < below {
            // The word may have to be rejected. This is so rare, exploring or not, that a branch costs nothing.
            cold_path();
            if !explores {
                self.used += 1;
                return (false, 0);
            }
            self.used += 1;
            return (true, self.integers(below));
        }
        let uses_word = explores & !self.has_uint32;
        self.used += 1 + usize::from(uses_word);
        self.buffered_u32 = std::hint::select_unpredictable(uses_word, (word >> 32) as u32, self.buffered_u32);
        self.has_uint32 ^= explores;
        (explores, (product >> 32) as u32)
    }

    fn next_u64(&mut self) -> u64 {
        if self.used == CAPACITY {
            self.refill();
        }
        self.used += 1;
        self.words[self.used - 1]
    }

    fn next_u32(&mut self) -> u32 {
        if self.has_uint32 {
            self.has_uint32 = false;
            return self.buffered_u32;
        }
        let word = self.next_u64();
        self.buffered_u32 = (word >> 32) as u32;
        self.has_uint32 = true;
        word as u32
    }

    /// Moves the unused words to the front and draws the rest.
    #[cold]
    fn refill(&mut self) {
        for _ in 0..self.used {
            self.start.next_u64();
        }
        self.words.copy_within(self.used.., 0);
        for word in &mut self.words[CAPACITY - self.used..] {
            *word = self.end.next_u64();
        }
        self.used = 0;
    }
}

impl Rng for PrefetchedPcg64 {
    fn random(&mut self) -> f64 {
        u64_to_f64(self.next_u64())
    }

    fn integers(&mut self, below: u32) -> u32 {
        lemire_bounded(below, || self.next_u32())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::random::{Rng, SeedSequence};

    proptest! {
        #[test]
        fn draws_and_final_state_match_pcg64(
            seed in any::<u32>(),
            before in 0_usize..3,
            draws in prop::collection::vec((0.0..1.1, 0_u32..9, 2_u32..20), 0..300),
        ) {
            let mut rng = Pcg64::new(&SeedSequence::new(&[seed]));
            (0..before).for_each(|_| {
                rng.integers(7);
            });
            let mut prefetched = PrefetchedPcg64::new(&rng);
            for (greedy, kind, below) in draws {
                match kind {
                    0 => prop_assert_eq!(prefetched.random(), rng.random()),
                    1 => prop_assert_eq!(prefetched.integers(below), rng.integers(below)),
                    _ => {
                        let explores = rng.random() >= greedy;
                        let (explored, action) = prefetched.explore(greedy, below);
                        prop_assert_eq!(explored, explores);
                        if explores {
                            prop_assert_eq!(action, rng.integers(below));
                        }
                    }
                }
            }
            prop_assert_eq!(prefetched.into_pcg64(), rng);
        }
    }
}
