//! The trait of all random generators.

/// 2⁵³, the number of floats that `random()` can return.
pub(crate) const TWO_POW_53: f64 = 9_007_199_254_740_992.0;

/// A random generator whose draws are those of `NumPy`.
pub trait Rng {
    /// The next float in [0, 1), a multiple of 2⁻⁵³: `rng.random()`.
    fn random(&mut self) -> f64;

    /// The same draw as `random()`, as an integer in units of 2⁻⁵³: integers compare faster than floats.
    #[inline]
    fn random_u53(&mut self) -> u64 {
        (self.random() * TWO_POW_53) as u64
    }

    /// The next integer in [0, `below`): `rng.integers(0, below)`. Draws nothing if `below` is 0 or 1, and returns 0.
    fn integers(&mut self, below: u32) -> u32;

    /// A number that depends on the seed, but not on the draws since, so that a checkpoint of another seed is refused;
    /// `None` if the generator does not know its seed.
    fn seed_fingerprint(&self) -> Option<u64> {
        None
    }

    /// The next float in [`low`, `high`): `rng.uniform(low, high)`.
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.random()
    }
}

/// A generator for code that draws no numbers: every draw is 0.
#[derive(Clone, Copy, Debug)]
pub struct NoRng;

impl Rng for NoRng {
    fn random(&mut self) -> f64 {
        0.0
    }
    fn integers(&mut self, _below: u32) -> u32 {
        0
    }
}
