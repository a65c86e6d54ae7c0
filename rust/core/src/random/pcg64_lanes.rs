//! Several PCG64 generators in SIMD lanes, for ε-greedy decisions without a branch.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::pcg64::upper_53_bits;
use super::pcg64_engine::{MULTIPLIER, Pcg64Engine, word};
use super::{Pcg64, Rng, TWO_POW_53};
use crate::numeric::{cold_path, mask, select};

/// The lower 32 bits of a word.
const LOWER_HALF: u64 = 0xffff_ffff;

/// One [`Pcg64`] per lane, as a structure of arrays.
#[derive(Clone)]
pub(crate) struct Pcg64Lanes<const K: usize> {
    /// The lower and the upper 64 bits of the states.
    state: [[u64; K]; 2],
    /// Those of the increments.
    increment: [[u64; K]; 2],
    buffered_u32: [u64; K],
    /// A mask per lane: all bits, or none.
    has_buffered_u32: [u64; K],
    words_drawn: [u64; K],
}

/// ε-greedy decisions, one per lane.
pub(crate) struct Decisions<const K: usize> {
    /// Whether to explore, as a mask of all bits.
    pub(crate) explores: [u64; K],
    /// The random action, which is arbitrary if the lane does not explore.
    pub(crate) random: [usize; K],
}

/// The least draw of `random_u53` that explores if `random()` is to be at least `greedy_below`, which must not be negative.
/// `random()` is an integer `n` times 2⁻⁵³, so `random() >= greedy_below` says that `n` is at least 2⁵³ × `greedy_below`,
/// which is exact, or the next integer above it.
pub(crate) fn explore_from(greedy_below: f64) -> u64 {
    (greedy_below * TWO_POW_53).ceil() as u64
}

impl<const K: usize> Pcg64Lanes<K> {
    /// Continues the draws of these generators.
    pub(crate) fn new(rngs: [&Pcg64; K]) -> Self {
        let mut lanes = Self {
            state: [[0; K]; 2],
            increment: [[0; K]; 2],
            buffered_u32: [0; K],
            has_buffered_u32: [0; K],
            words_drawn: [0; K],
        };
        for (lane, rng) in rngs.into_iter().enumerate() {
            lanes.set(lane, rng);
        }
        lanes
    }

    /// The generator of a lane.
    pub(crate) fn get(&self, lane: usize) -> Pcg64 {
        let number = |[low, high]: &[[u64; K]; 2]| u128::from(low[lane]) | u128::from(high[lane]) << 64;
        Pcg64 {
            engine: Pcg64Engine { state: number(&self.state), increment: number(&self.increment) },
            buffered_u32: (self.has_buffered_u32[lane] != 0).then_some(self.buffered_u32[lane] as u32),
            words_drawn: self.words_drawn[lane],
        }
    }

    /// Continues the draws of a generator in a lane.
    pub(crate) fn set(&mut self, lane: usize, rng: &Pcg64) {
        let Pcg64 { engine: Pcg64Engine { state, increment }, buffered_u32, words_drawn } = rng;
        for (lanes, number) in [(&mut self.state, state), (&mut self.increment, increment)] {
            lanes[0][lane] = *number as u64;
            lanes[1][lane] = (number >> 64) as u64;
        }
        self.buffered_u32[lane] = buffered_u32.unwrap_or_default().into();
        self.has_buffered_u32[lane] = mask(buffered_u32.is_some());
        self.words_drawn[lane] = *words_drawn;
    }

    /// An ε-greedy decision of one lane: `integers(below)` if `random_u53()` is at least [`explore_from`].
    pub(crate) fn explore_one(&mut self, lane: usize, explore_from: u64, below: u32) -> Option<usize> {
        let mut rng = self.get(lane);
        let random = (rng.random_u53() >= explore_from).then(|| rng.integers(below) as usize);
        self.set(lane, &rng);
        random
    }

    /// The decision of every lane. `below` must be greater than 1. A lane that does not explore draws one word, one that
    /// does draws another unless it has a buffered half. Both words are computed, and the state after the last one used is
    /// kept.
    #[inline(always)]
    pub(crate) fn explore(&mut self, explore_from: &[u64; K], below: u32) -> Decisions<K> {
        let first = self.next_states(&self.state);
        let second = self.next_states(&first);
        let (first_word, next_word) = (words(&first), words(&second));
        let mut decisions = Decisions { explores: [0; K], random: [0; K] };
        let mut rejected = 0;
        for lane in 0..K {
            let explores = mask(upper_53_bits(first_word[lane]) >= explore_from[lane]);
            let half = select(self.has_buffered_u32[lane], self.buffered_u32[lane], next_word[lane]) & LOWER_HALF;
            let product = half * u64::from(below);
            rejected |= explores & mask((product & LOWER_HALF) < u64::from(below));
            decisions.explores[lane] = explores;
            decisions.random[lane] = (product >> 32) as usize;
        }
        if rejected != 0 {
            // An integer may have to be rejected. This is so rare that a branch costs nothing.
            cold_path();
            return self.explore_one_by_one(explore_from, below);
        }
        for lane in 0..K {
            let explores = decisions.explores[lane];
            let uses_next = explores & !self.has_buffered_u32[lane];
            self.state[0][lane] = select(uses_next, second[0][lane], first[0][lane]);
            self.state[1][lane] = select(uses_next, second[1][lane], first[1][lane]);
            self.buffered_u32[lane] = select(uses_next, next_word[lane] >> 32, self.buffered_u32[lane]);
            // A mask is -1 as a number.
            self.words_drawn[lane] = (self.words_drawn[lane] + 1).wrapping_sub(uses_next);
            self.has_buffered_u32[lane] ^= explores;
        }
        decisions
    }

    #[inline(never)]
    fn explore_one_by_one(&mut self, explore_from: &[u64; K], below: u32) -> Decisions<K> {
        let actions: [_; K] = std::array::from_fn(|lane| self.explore_one(lane, explore_from[lane], below));
        Decisions {
            explores: actions.map(|action| mask(action.is_some())),
            random: actions.map(Option::unwrap_or_default),
        }
    }

    /// The states after these. 64-bit products are sums of products of 32-bit halves, which vector instructions have.
    #[inline(always)]
    fn next_states(&self, [low, high]: &[[u64; K]; 2]) -> [[u64; K]; 2] {
        const LOW: u64 = MULTIPLIER as u64;
        const HIGH: u64 = (MULTIPLIER >> 64) as u64;
        const HALVES: [u64; 2] = [LOW & LOWER_HALF, LOW >> 32];
        let mut next = [[0; K]; 2];
        for lane in 0..K {
            let halves = [low[lane] & LOWER_HALF, low[lane] >> 32];
            let lowest = halves[0] * HALVES[0];
            let middle = halves[1] * HALVES[0] + (lowest >> 32);
            let other_middle = halves[0] * HALVES[1] + (middle & LOWER_HALF);
            let highest = halves[1] * HALVES[1] + (middle >> 32) + (other_middle >> 32);
            let product_low = (other_middle << 32) | (lowest & LOWER_HALF);
            let product_high =
                highest.wrapping_add(low[lane].wrapping_mul(HIGH)).wrapping_add(high[lane].wrapping_mul(LOW));
            let sum = product_low.wrapping_add(self.increment[0][lane]);
            let carry = u64::from(sum < product_low);
            next[0][lane] = sum;
            next[1][lane] = product_high.wrapping_add(self.increment[1][lane]).wrapping_add(carry);
        }
        next
    }
}

/// The words of these states.
#[inline(always)]
fn words<const K: usize>([low, high]: &[[u64; K]; 2]) -> [u64; K] {
    std::array::from_fn(|lane| word(low[lane], high[lane]))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::random::pcg64::u64_to_f64;
    use crate::random::{Rng as _, SeedSequence};

    const LANES: usize = 5;

    proptest! {
        #[test]
        fn decisions_and_final_states_match_pcg64(
            seed in any::<u32>(),
            draws in prop::collection::vec(
                (
                    prop::array::uniform5(prop_oneof![0.0..=1.0, Just(0.0), Just(1.0)]),
                    // With numbers near 2³², every other one is rejected.
                    prop_oneof![4 => 2_u32..20, 1 => (1_u32 << 31)..=u32::MAX],
                ),
                0..60,
            ),
        ) {
            let mut rngs: [_; LANES] = std::array::from_fn(|lane| {
                let mut rng = Pcg64::new(&SeedSequence::new(&[seed, lane as u32]));
                (0..lane).for_each(|_| {
                    rng.integers(7);
                });
                rng
            });
            let mut lanes = Pcg64Lanes::new(rngs.each_ref());
            for (greedy_below, below) in draws {
                let explore_from = greedy_below.map(explore_from);
                let decisions = lanes.explore(&explore_from, below);
                for (lane, rng) in rngs.iter_mut().enumerate() {
                    let expected = (rng.random() >= greedy_below[lane]).then(|| rng.integers(below) as usize);
                    prop_assert_eq!((decisions.explores[lane] != 0).then_some(decisions.random[lane]), expected);
                }
            }
            for (lane, rng) in rngs.iter().enumerate() {
                prop_assert_eq!(&lanes.get(lane), rng);
            }
        }

        #[test]
        fn the_integer_threshold_is_exact(random in 0_u64..1 << 53, offset in -1_i64..=1, epsilon in 0.0..=1.0) {
            let near = (random.saturating_add_signed(offset)) as f64 / TWO_POW_53;
            for greedy_below in [near, 1.0 - epsilon, near / 3.0, f64::MIN_POSITIVE, 0.0, 1.0] {
                for random in [random, (greedy_below * TWO_POW_53) as u64] {
                    let explores = u64_to_f64(random << 11) >= greedy_below;
                    prop_assert_eq!(random >= explore_from(greedy_below), explores || random >= 1 << 53);
                }
            }
        }
    }
}
