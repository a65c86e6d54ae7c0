//! Several PCG64 generators in SIMD lanes, for ε-greedy decisions without a branch.

use super::pcg64::{MULTIPLIER, Pcg64Engine};
use super::{Pcg64, Rng, TWO_POW_53};
use crate::numeric::cold_path;
use crate::simd::{Mask, Simd, U64s};

/// The lower 32 bits of a word.
const LOWER_HALF: u64 = 0xffff_ffff;

/// One [`Pcg64`] per lane, as a structure of arrays.
#[derive(Clone)]
pub(crate) struct Pcg64Lanes<S: Simd, const K: usize> {
    /// The lower and the upper 64 bits of the states.
    state: [U64s<S, K>; 2],
    /// The lower and the upper 64 bits of the increments.
    increment: [U64s<S, K>; 2],
    buffered_u32: U64s<S, K>,
    has_buffered_u32: Mask<S, K>,
    words_drawn: U64s<S, K>,
}

/// ε-greedy decisions, one per lane.
pub(crate) struct Decisions<S: Simd, const K: usize> {
    /// Whether to explore.
    pub(crate) explores: Mask<S, K>,
    /// The random action, which is arbitrary if the lane does not explore.
    pub(crate) random: U64s<S, K>,
}

/// The smallest draw of `random_u53` that explores if `random()` must be at least `greedy_below`, which must not be
/// negative. `random()` is an integer `n` times 2⁻⁵³, so `random() >= greedy_below` means that `n` is at least 2⁵³ ×
/// `greedy_below`, which is exact, or the next integer above it.
pub(crate) fn explore_from(greedy_below: f64) -> u64 {
    (greedy_below * TWO_POW_53).ceil() as u64
}

impl<S: Simd, const K: usize> Pcg64Lanes<S, K> {
    /// Continues the draws of these generators.
    pub(crate) fn new(simd: S, rngs: [&Pcg64; K]) -> Self {
        let zeros = U64s::splat(simd, 0);
        let mut lanes = Self {
            state: [zeros; 2],
            increment: [zeros; 2],
            buffered_u32: zeros,
            has_buffered_u32: Mask::new(simd, [false; K]),
            words_drawn: zeros,
        };
        for (lane, rng) in rngs.into_iter().enumerate() {
            lanes.set(lane, rng);
        }
        lanes
    }

    /// The generator of a lane.
    pub(crate) fn get(&self, lane: usize) -> Pcg64 {
        let number = |halves: [U64s<S, K>; 2]| {
            let [low, high] = halves.map(|half| u128::from(half.to_array()[lane]));
            low | high << 64
        };
        let buffered_u32 = self.buffered_u32.to_array()[lane] as u32;
        Pcg64 {
            engine: Pcg64Engine { state: number(self.state), increment: number(self.increment) },
            buffered_u32: self.has_buffered_u32.to_array()[lane].then_some(buffered_u32),
            words_drawn: self.words_drawn.to_array()[lane],
        }
    }

    /// Continues the draws of a generator in a lane.
    pub(crate) fn set(&mut self, lane: usize, rng: &Pcg64) {
        let Pcg64 { engine: Pcg64Engine { state, increment }, buffered_u32, words_drawn } = rng;
        for (halves, number) in [(&mut self.state, state), (&mut self.increment, increment)] {
            halves[0].set(lane, *number as u64);
            halves[1].set(lane, (number >> 64) as u64);
        }
        self.buffered_u32.set(lane, buffered_u32.unwrap_or_default().into());
        self.has_buffered_u32.set(lane, buffered_u32.is_some());
        self.words_drawn.set(lane, *words_drawn);
    }

    /// An ε-greedy decision of one lane: `integers(below)` if `random_u53()` is at least [`explore_from`].
    pub(crate) fn explore_one(&mut self, lane: usize, explore_from: u64, below: u32) -> Option<usize> {
        let mut rng = self.get(lane);
        let random = (rng.random_u53() >= explore_from).then(|| rng.integers(below) as usize);
        self.set(lane, &rng);
        random
    }

    /// The decision of every lane. `below` must be greater than 1. A lane that does not explore draws one word; a lane
    /// that does draws another unless it has a buffered half. Both words are computed, and the state after the last one
    /// used is kept.
    #[inline(always)]
    pub(crate) fn explore(&mut self, simd: S, explore_from: U64s<S, K>, below: u32) -> Decisions<S, K> {
        let first = self.next_states(self.state);
        let second = self.next_states(first);
        let (first_word, next_word) = (words(first), words(second));
        let explores = !first_word.shift_right::<11>().less(explore_from);
        let product = self.has_buffered_u32.select(self.buffered_u32, next_word).mul_lower(u64::from(below));
        if (explores & (product & LOWER_HALF).less(u64::from(below))).any() {
            // An integer may have to be rejected. This is so rare that a branch costs nothing.
            cold_path();
            return self.explore_one_by_one(simd, explore_from, below);
        }
        let uses_next = explores & !self.has_buffered_u32;
        self.state = [uses_next.select(second[0], first[0]), uses_next.select(second[1], first[1])];
        self.buffered_u32 = uses_next.select(next_word.shift_right::<32>(), self.buffered_u32);
        self.words_drawn = (self.words_drawn + 1).incremented_where(uses_next);
        self.has_buffered_u32 = self.has_buffered_u32 ^ explores;
        Decisions { explores, random: product.shift_right::<32>() }
    }

    #[cold]
    #[inline(never)]
    fn explore_one_by_one(&mut self, simd: S, explore_from: U64s<S, K>, below: u32) -> Decisions<S, K> {
        let explore_from = explore_from.to_array();
        let actions: [_; K] = std::array::from_fn(|lane| self.explore_one(lane, explore_from[lane], below));
        Decisions {
            explores: Mask::new(simd, actions.map(|action| action.is_some())),
            random: U64s::new(simd, actions.map(|action| action.unwrap_or_default() as u64)),
        }
    }

    /// The states that follow. The 64-bit products are sums of products of 32-bit halves, for which there are vector
    /// instructions.
    #[inline(always)]
    fn next_states(&self, [low, high]: [U64s<S, K>; 2]) -> [U64s<S, K>; 2] {
        const LOW: u64 = MULTIPLIER as u64;
        const HIGH: u64 = (MULTIPLIER >> 64) as u64;
        let upper_half = low.shift_right::<32>();
        let lowest = low.mul_lower(LOW);
        let middle = upper_half.mul_lower(LOW) + lowest.shift_right::<32>();
        let other_middle = low.mul_lower(LOW >> 32) + (middle & LOWER_HALF);
        let highest = upper_half.mul_lower(LOW >> 32) + middle.shift_right::<32>() + other_middle.shift_right::<32>();
        let product_low = other_middle.shift_left::<32>() | (lowest & LOWER_HALF);
        let product_high = highest + low * HIGH + high * LOW;
        let sum = product_low + self.increment[0];
        [sum, (product_high + self.increment[1]).incremented_where(sum.less(product_low))]
    }
}

/// The words of these states.
#[inline(always)]
fn words<S: Simd, const K: usize>([low, high]: [U64s<S, K>; 2]) -> U64s<S, K> {
    (low ^ high).rotate_right(high.shift_right::<58>())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::random::pcg64::u64_to_f64;
    use crate::random::{Rng, SeedSequence};
    use crate::simd::{SimdCode, SimdLevel};

    const LANES: usize = 5;

    /// The thresholds and the numbers of actions of some draws, and the initial generators.
    #[derive(Clone, Copy)]
    struct Draws<'a>(&'a [([f64; LANES], u32)], [&'a Pcg64; LANES]);

    impl SimdCode for Draws<'_> {
        const USES_AVX512: bool = true;

        /// The random action of each lane that explores, draw by draw, and the final generators.
        type Output = (Vec<[Option<u64>; LANES]>, [Pcg64; LANES]);

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let Self(draws, rngs) = self;
            let mut lanes = Pcg64Lanes::new(simd, rngs);
            let mut actions = Vec::new();
            for &(greedy_below, below) in draws {
                let decisions = lanes.explore(simd, U64s::new(simd, greedy_below.map(explore_from)), below);
                let (explores, random) = (decisions.explores.to_array(), decisions.random.to_array());
                actions.push(std::array::from_fn(|lane| explores[lane].then_some(random[lane])));
            }
            (actions, std::array::from_fn(|lane| lanes.get(lane)))
        }
    }

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
            let begun = rngs.clone();
            let mut actions = Vec::new();
            for (greedy_below, below) in &draws {
                actions.push(std::array::from_fn(|lane| {
                    let rng = &mut rngs[lane];
                    (Rng::random(rng) >= greedy_below[lane]).then(|| u64::from(rng.integers(*below)))
                }));
            }
            for level in SimdLevel::available() {
                let found = level.run(Draws(&draws, begun.each_ref()));
                prop_assert_eq!(&found, &(actions.clone(), rngs.clone()), "{:?}", level);
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
