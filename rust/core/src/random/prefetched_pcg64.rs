//! A stream whose words are drawn ahead, so that taking one more or one fewer needs no branch.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]
#![expect(clippy::needless_bitwise_bool, reason = "a lazy operator would be an unpredictable branch")]

use super::pcg64::{lemire_bounded, u64_to_f64};
use super::{Pcg64, Rng};
use crate::numeric::cold_path;

const PREFETCHED: usize = 64;

/// What `Pcg64` would draw, drawn already.
pub(crate) struct PrefetchedPcg64 {
    /// The stream at the first of the words.
    start: Pcg64,
    /// The stream after the last of them.
    end: Pcg64,
    ahead: [u64; PREFETCHED],
    taken: usize,
    buffered_u32: u32,
    has_uint32: bool,
}

impl PrefetchedPcg64 {
    pub(crate) fn new(stream: &Pcg64) -> Self {
        let buffered_u32 = stream.buffered_u32();
        let mut end = stream.clone();
        let ahead = std::array::from_fn(|_| end.next_u64());
        Self {
            start: stream.clone(),
            end,
            ahead,
            taken: 0,
            buffered_u32: buffered_u32.unwrap_or(0),
            has_uint32: buffered_u32.is_some(),
        }
    }

    /// The stream as it would be had the words been drawn from it one by one.
    pub(crate) fn into_pcg64(self) -> Pcg64 {
        let mut stream = self.start.clone();
        for _ in 0..self.taken {
            stream.next_u64();
        }
        stream.set_buffered_u32(self.has_uint32.then_some(self.buffered_u32));
        stream
    }

    /// Whether `random()` is at least `greedy`, and what `integers(below)` gives if it is, drawn only then; `below` is
    /// more than 1.
    #[inline(always)]
    pub(crate) fn explore(&mut self, greedy: f64, below: u32) -> (bool, u32) {
        if self.taken + 2 > PREFETCHED {
            self.refill();
        }
        let explores = u64_to_f64(self.ahead[self.taken]) >= greedy;
        let word = self.ahead[self.taken + 1];
        let buffered_u32 = std::hint::select_unpredictable(self.has_uint32, self.buffered_u32, word as u32);
        let product = u64::from(buffered_u32) * u64::from(below);
        if (product as u32) < below {
            // One in a billion: it may have to be rejected. Seldom whether it explores or not, so that is asked later.
            cold_path();
            if !explores {
                self.taken += 1;
                return (false, 0);
            }
            self.taken += 1;
            return (true, self.integers(below));
        }
        let draws = explores & !self.has_uint32;
        self.taken += 1 + usize::from(draws);
        self.buffered_u32 = std::hint::select_unpredictable(draws, (word >> 32) as u32, self.buffered_u32);
        self.has_uint32 ^= explores;
        (explores, (product >> 32) as u32)
    }

    fn next_u64(&mut self) -> u64 {
        if self.taken == PREFETCHED {
            self.refill();
        }
        self.taken += 1;
        self.ahead[self.taken - 1]
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

    /// Moves what is left to the front and draws the rest.
    #[cold]
    fn refill(&mut self) {
        for _ in 0..self.taken {
            self.start.next_u64();
        }
        self.ahead.copy_within(self.taken.., 0);
        for word in &mut self.ahead[PREFETCHED - self.taken..] {
            *word = self.end.next_u64();
        }
        self.taken = 0;
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
        fn the_draws_and_the_stream_are_those_of_the_stream_itself(
            seed in any::<u32>(),
            before in 0_usize..3,
            rngs in prop::collection::vec((0.0..1.1, 0_u32..9, 2_u32..20), 0..300),
        ) {
            let mut stream = Pcg64::new(&SeedSequence::new(&[seed]));
            (0..before).for_each(|_| {
                stream.integers(7);
            });
            let mut words = PrefetchedPcg64::new(&stream);
            for (greedy, kind, below) in rngs {
                match kind {
                    0 => prop_assert_eq!(words.random(), stream.random()),
                    1 => prop_assert_eq!(words.integers(below), stream.integers(below)),
                    _ => {
                        let explores = stream.random() >= greedy;
                        let (explored, action) = words.explore(greedy, below);
                        prop_assert_eq!(explored, explores);
                        if explores {
                            prop_assert_eq!(action, stream.integers(below));
                        }
                    }
                }
            }
            prop_assert_eq!(words.into_pcg64(), stream);
        }
    }
}
