//! `numpy.random.RandomState(seed)`, the generator behind `np.random.seed(seed)` and `np.random.random()`.

use rand_mt::Mt;

use super::Rng;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};

/// The number of 32-bit words of the state.
const WORDS: usize = 624;

/// The Mersenne Twister with `NumPy`'s legacy seeding and legacy draws.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mt19937 {
    engine: Mt,
    /// Words that the engine has drawn but not used yet, the next one last. Only a restored generator has any.
    drawn: Vec<u32>,
}

impl Mt19937 {
    /// `numpy.random.RandomState(seed)`. Its numbers differ from those of `Generator(MT19937(seed))`.
    pub fn new(seed: u32) -> Self {
        Self { engine: Mt::new(seed), drawn: Vec::new() }
    }

    #[inline]
    fn next_u32(&mut self) -> u32 {
        match self.drawn.pop() {
            Some(word) => word,
            None => self.engine.next_u32(),
        }
    }
}

impl Rng for Mt19937 {
    /// `random_sample()`: 53 bits from two 32-bit words.
    #[inline]
    fn random(&mut self) -> f64 {
        let high = f64::from(self.next_u32() >> 5);
        let low = f64::from(self.next_u32() >> 6);
        (high * 67_108_864.0 + low) / 9_007_199_254_740_992.0
    }

    /// `randint(0, below)`: masked rejection sampling.
    #[inline]
    fn integers(&mut self, below: u32) -> u32 {
        if below <= 1 {
            return 0;
        }
        let largest = below - 1;
        let mask = u32::MAX >> largest.leading_zeros();
        loop {
            let value = self.next_u32() & mask;
            if value <= largest {
                return value;
            }
        }
    }
}

/// The next 624 words, the size of the state, which determine all later ones.
impl Persist for Mt19937 {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let mut same = self.clone();
        let mut words = [(); WORDS].map(|()| same.next_u32());
        words.persist(checkpoint)?;
        if checkpoint.is_restoring() {
            self.engine = Mt::from(words);
            self.drawn = words.into_iter().rev().collect();
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_draws_of_seed_0_match_numpy() {
        // rng = np.random.RandomState(0); rng.random(), rng.randint(0, 3), rng.random()
        let mut rng = Mt19937::new(0);
        assert_eq!(rng.random(), 0.548_813_503_927_324_8);
        assert_eq!(rng.integers(3), 1);
        assert_eq!(rng.random(), 0.844_265_748_581_017_3);
    }
}
