//! A PCG64 that draws its words in advance, so that exploring or not needs no branch.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]
#![expect(clippy::needless_bitwise_bool, reason = "a lazy operator would be an unpredictable branch")]

use super::pcg64::{lemire_bounded, u64_to_f64, upper_53_bits};
use super::{Pcg64, Rng, TWO_POW_53};
use crate::numeric::cold_path;

/// The number of words drawn in advance.
const CAPACITY: usize = 64;

/// A [`Pcg64`] with a buffer of its next words. Its draws are those of the [`Pcg64`].
pub(crate) struct PrefetchedPcg64 {
    /// The generator before all draws.
    start: Pcg64,
    /// The number of words between `start` and the first buffered word.
    skipped: u64,
    /// The generator after the last buffered word.
    end: Pcg64,
    words: [u64; CAPACITY],
    /// The number of buffered words used.
    used: usize,
    half: Half,
}

/// The buffer of one 32-bit half.
#[derive(Clone, Copy)]
struct Half {
    buffered_u32: u32,
    has_uint32: bool,
}

/// A position in the draws, to return to.
#[derive(Clone, Copy)]
pub(crate) struct DrawIndex {
    /// The number of words drawn before.
    words: u64,
    half: Half,
}

impl PrefetchedPcg64 {
    /// The most decisions that [`explore_many`](Self::explore_many) draws at once.
    pub(crate) const MAX_DECISIONS: usize = CAPACITY / 2;

    /// Continues the draws of `rng`.
    pub(crate) fn new(rng: &Pcg64) -> Self {
        let buffered_u32 = rng.buffered_u32();
        let mut end = rng.clone();
        let words = std::array::from_fn(|_| end.next_u64());
        let half = Half { buffered_u32: buffered_u32.unwrap_or(0), has_uint32: buffered_u32.is_some() };
        Self { start: rng.clone(), skipped: 0, end, words, used: 0, half }
    }

    /// The generator after the draws made so far.
    pub(crate) fn into_pcg64(self) -> Pcg64 {
        let mut rng = self.start;
        rng.advance(self.skipped + self.used as u64);
        rng.set_buffered_u32(self.half.has_uint32.then_some(self.half.buffered_u32));
        rng
    }

    /// The position after the draws made so far.
    pub(crate) fn position(&self) -> DrawIndex {
        DrawIndex { words: self.skipped + self.used as u64, half: self.half }
    }

    /// Returns to an earlier position.
    pub(crate) fn rewind(&mut self, position: DrawIndex) {
        self.half = position.half;
        if let Some(used) = position.words.checked_sub(self.skipped) {
            self.used = used as usize;
            return;
        }
        self.end = self.start.clone();
        self.end.advance(position.words);
        self.skipped = position.words;
        self.used = CAPACITY;
        self.fill();
    }

    /// The words from which on `random()` is at least `greedy_below`, which must not be negative, as an argument of
    /// [`explore_many`](Self::explore_many). `random()` is an integer `n` times 2⁻⁵³, so `random() >= greedy_below` says
    /// that `n` is at least 2⁵³ × `greedy_below`, which is exact, or the next integer above it.
    pub(crate) fn explore_from(greedy_below: f64) -> u64 {
        (greedy_below * TWO_POW_53).ceil() as u64
    }

    /// `count` ε-greedy decisions, in order: whether `random()` is at least the probability that `explore_from` was made
    /// of (explore), and if so `integers(below)`, which is drawn only then. `below` must be greater than 1. `put` receives
    /// the index of a decision, whether it explores, and the integer, which is arbitrary otherwise.
    #[inline(always)]
    pub(crate) fn explore_many(
        &mut self,
        count: usize,
        explore_from: u64,
        below: u32,
        mut put: impl FnMut(usize, bool, usize),
    ) {
        debug_assert!(count <= Self::MAX_DECISIONS, "each takes up to two words");
        if self.used + 2 * count > CAPACITY {
            self.refill();
        }
        let (mut used, mut half) = (self.used, self.half);
        for index in 0..count {
            // The mask changes nothing, but saves a check.
            let (word, next_word) = (self.words[used % CAPACITY], self.words[(used + 1) % CAPACITY]);
            let explores = upper_53_bits(word) >= explore_from;
            let random = std::hint::select_unpredictable(half.has_uint32, half.buffered_u32, next_word as u32);
            let product = u64::from(random) * u64::from(below);
            if (product as u32) < below {
                // The integer may have to be rejected. This is so rare, exploring or not, that a branch costs nothing.
                cold_path();
                (self.used, self.half) = (used + 1, half);
                put(index, explores, if explores { self.integers(below) as usize } else { 0 });
                if self.used + 2 * count > CAPACITY {
                    self.refill();
                }
                (used, half) = (self.used, self.half);
                continue;
            }
            let uses_word = explores & !half.has_uint32;
            used += 1 + usize::from(uses_word);
            half.buffered_u32 = std::hint::select_unpredictable(uses_word, (next_word >> 32) as u32, half.buffered_u32);
            half.has_uint32 ^= explores;
            put(index, explores, (product >> 32) as usize);
        }
        (self.used, self.half) = (used, half);
    }

    fn next_u64(&mut self) -> u64 {
        if self.used == CAPACITY {
            self.refill();
        }
        self.used += 1;
        self.words[self.used - 1]
    }

    fn next_u32(&mut self) -> u32 {
        if self.half.has_uint32 {
            self.half.has_uint32 = false;
            return self.half.buffered_u32;
        }
        let word = self.next_u64();
        self.half = Half { buffered_u32: (word >> 32) as u32, has_uint32: true };
        word as u32
    }

    /// Moves the unused words to the front and draws the rest.
    #[cold]
    fn refill(&mut self) {
        self.words.copy_within(self.used.., 0);
        self.skipped += self.used as u64;
        self.fill();
    }

    /// Draws the words that were used.
    fn fill(&mut self) {
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

    /// A decision of the plain generator: the action if it explores.
    fn explore(rng: &mut Pcg64, greedy_below: f64, below: u32) -> Option<usize> {
        (rng.random() >= greedy_below).then(|| rng.integers(below) as usize)
    }

    proptest! {
        #[test]
        fn draws_and_final_state_match_pcg64(
            seed in any::<u32>(),
            before in 0_usize..3,
            draws in prop::collection::vec(
                (
                    prop_oneof![0.0..=1.0, Just(0.0), Just(1.0)],
                    0_u32..9,
                    // With numbers near 2³², every other one is rejected.
                    prop_oneof![4 => 2_u32..20, 1 => (1_u32 << 31)..=u32::MAX],
                    0..=PrefetchedPcg64::MAX_DECISIONS,
                ),
                0..60,
            ),
        ) {
            let mut rng = Pcg64::new(&SeedSequence::new(&[seed]));
            (0..before).for_each(|_| {
                rng.integers(7);
            });
            let mut prefetched = PrefetchedPcg64::new(&rng);
            let mut earlier = (prefetched.position(), rng.clone());
            for (greedy_below, kind, below, count) in draws {
                match kind {
                    0 => prop_assert_eq!(prefetched.random(), rng.random()),
                    1 => prop_assert_eq!(prefetched.integers(below), rng.integers(below)),
                    2 => earlier = (prefetched.position(), rng.clone()),
                    3 => {
                        prefetched.rewind(earlier.0);
                        rng = earlier.1.clone();
                    }
                    _ => {
                        let mut decisions = Vec::new();
                        let explore_from = PrefetchedPcg64::explore_from(greedy_below);
                        prefetched.explore_many(count, explore_from, below, |index, explores, action| {
                            assert_eq!(index, decisions.len());
                            decisions.push(explores.then_some(action));
                        });
                        let expected: Vec<_> = (0..count).map(|_| explore(&mut rng, greedy_below, below)).collect();
                        prop_assert_eq!(decisions, expected);
                    }
                }
            }
            prop_assert_eq!(prefetched.into_pcg64(), rng);
        }

        #[test]
        fn the_integer_threshold_is_exact(random in 0_u64..1 << 53, offset in -1_i64..=1, epsilon in 0.0..=1.0) {
            let near = (random.saturating_add_signed(offset)) as f64 / TWO_POW_53;
            for greedy_below in [near, 1.0 - epsilon, near / 3.0, f64::MIN_POSITIVE, 0.0, 1.0] {
                for random in [random, (greedy_below * TWO_POW_53) as u64] {
                    let explores = u64_to_f64(random << 11) >= greedy_below;
                    prop_assert_eq!(random >= PrefetchedPcg64::explore_from(greedy_below), explores || random >= 1 << 53);
                }
            }
        }
    }
}
