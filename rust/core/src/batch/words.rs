//! A stream whose words are drawn ahead, so that taking one more or one fewer needs no branch.

use crate::hint::seldom;
use crate::random::{Draw, Pcg64, bounded, unit};

const AHEAD: usize = 64;

/// What `Pcg64` would draw, drawn already.
pub(super) struct Words {
    /// The stream at the first of the words.
    start: Pcg64,
    /// The stream after the last of them.
    end: Pcg64,
    ahead: [u64; AHEAD],
    taken: usize,
    half: u32,
    halved: bool,
}

impl Words {
    pub(super) fn new(stream: &Pcg64) -> Self {
        let half = stream.half();
        let mut end = stream.clone();
        let ahead = std::array::from_fn(|_| end.next_u64());
        Self { start: stream.clone(), end, ahead, taken: 0, half: half.unwrap_or(0), halved: half.is_some() }
    }

    /// The stream as it would be had the words been drawn from it one by one.
    pub(super) fn stream(&self) -> Pcg64 {
        let mut stream = self.start.clone();
        for _ in 0..self.taken {
            stream.next_u64();
        }
        stream.set_half(self.halved.then_some(self.half));
        stream
    }

    /// Whether `random()` is at least `greedy`, and what `integers(below)` gives if it is, drawn only then; `below` is
    /// more than 1.
    #[inline(always)]
    pub(super) fn explore(&mut self, greedy: f64, below: u32) -> (bool, u32) {
        if self.taken + 2 > AHEAD {
            self.refill();
        }
        let explores = unit(self.ahead[self.taken]) >= greedy;
        let word = self.ahead[self.taken + 1];
        let half = std::hint::select_unpredictable(self.halved, self.half, word as u32);
        let product = u64::from(half) * u64::from(below);
        if (product as u32) < below {
            // One in a billion: it may have to be rejected. Seldom whether it explores or not, so that is asked later.
            seldom();
            if !explores {
                self.taken += 1;
                return (false, 0);
            }
            self.taken += 1;
            return (true, self.integers(below));
        }
        let draws = explores & !self.halved;
        self.taken += 1 + usize::from(draws);
        self.half = std::hint::select_unpredictable(draws, (word >> 32) as u32, self.half);
        self.halved ^= explores;
        (explores, (product >> 32) as u32)
    }

    fn next_u64(&mut self) -> u64 {
        if self.taken == AHEAD {
            self.refill();
        }
        self.taken += 1;
        self.ahead[self.taken - 1]
    }

    fn next_u32(&mut self) -> u32 {
        if self.halved {
            self.halved = false;
            return self.half;
        }
        let word = self.next_u64();
        self.half = (word >> 32) as u32;
        self.halved = true;
        word as u32
    }

    /// Moves what is left to the front and draws the rest.
    #[cold]
    fn refill(&mut self) {
        for _ in 0..self.taken {
            self.start.next_u64();
        }
        self.ahead.copy_within(self.taken.., 0);
        for word in &mut self.ahead[AHEAD - self.taken..] {
            *word = self.end.next_u64();
        }
        self.taken = 0;
    }
}

impl Draw for Words {
    fn random(&mut self) -> f64 {
        unit(self.next_u64())
    }

    fn integers(&mut self, below: u32) -> u32 {
        bounded(below, || self.next_u32())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::random::SeedSequence;

    proptest! {
        #[test]
        fn the_draws_and_the_stream_are_those_of_the_stream_itself(
            seed in any::<u32>(),
            before in 0_usize..3,
            draws in prop::collection::vec((0.0..1.1, 0_u32..9, 2_u32..20), 0..300),
        ) {
            let mut stream = Pcg64::new(&SeedSequence::new(&[seed]));
            (0..before).for_each(|_| {
                stream.integers(7);
            });
            let mut words = Words::new(&stream);
            for (greedy, kind, below) in draws {
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
            prop_assert_eq!(words.stream(), stream);
        }
    }
}
