//! What an agent or an environment may ask of a stream.

/// How many floats `random()` knows: 2⁵³.
pub(crate) const TWO_POW_53: f64 = 9_007_199_254_740_992.0;

/// A stream of random numbers with `NumPy`'s draws.
pub trait Rng {
    /// The next float in [0, 1), on the grid of 2⁻⁵³: `rng.random()`.
    fn random(&mut self) -> f64;

    /// `random()` in units of 2⁻⁵³: the same draw as a whole number, which compares sooner than a float.
    #[inline]
    fn random_u53(&mut self) -> u64 {
        (self.random() * TWO_POW_53) as u64
    }

    /// The next integer in 0 … `below` - 1: `rng.integers(0, below)`. Draws nothing when `below` is 1 (or 0).
    fn integers(&mut self, below: u32) -> u32;

    /// The next float in [`low`, `high`): `rng.uniform(low, high)`.
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.random()
    }

    /// The next float of a normal distribution, by two draws of `random()` (Box & Muller, 1958): √(-2 ln(1 - u)) cos 2πv.
    /// Not `rng.normal(mean, deviation)`, which looks into tables of `NumPy`'s own.
    fn normal(&mut self, mean: f64, deviation: f64) -> f64 {
        let (u, v) = (self.random(), self.random());
        mean + deviation * ((-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos())
    }
}

/// For what draws nothing.
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
