//! `numpy.random.Generator.standard_normal`: the ziggurat method (J. Doornik, "An improved ziggurat method to generate
//! normal random samples", 2005), with `NumPy`'s order of draws and its tables.

use std::sync::LazyLock;

use super::{Pcg64, Rng};

/// The number of layers of the ziggurat.
const LAYERS: usize = 256;
/// The start of the tail: the right end of the lowest layer.
const TAIL: f64 = 3.654_152_885_361_009;
/// 1 / `TAIL`, as `NumPy` rounds it.
const TAIL_INVERSE: f64 = 0.273_661_237_329_758_3;
/// The area of a layer, as precisely as `NumPy`'s tables determine it.
const AREA: f64 = 0.004_928_673_233_974_652;
/// 2⁵², the number of values that a coordinate can have.
const TWO_POW_52: f64 = 4_503_599_627_370_496.0;

/// The layers, from the tail to the top: layer 0 includes the tail, and layer i > 0 ends at `xᵢ`.
struct Ziggurat {
    /// `xᵢ` / 2⁵², and then -`xᵢ` / 2⁵²: a branch on the sign would be mispredicted every other time.
    widths: [f64; 2 * LAYERS],
    /// The part of a layer, in units of 2⁻⁵² of it, that lies below the density.
    inner: [u64; LAYERS],
    /// exp(-`xᵢ`² / 2)
    heights: [f64; LAYERS],
}

static ZIGGURAT: LazyLock<Ziggurat> = LazyLock::new(Ziggurat::new);

impl Ziggurat {
    /// `NumPy`'s tables. They were computed with floats, not exactly: each operation here is one of those, and `exp`
    /// and `ln` are rounded correctly, so that the tables do not depend on the platform.
    fn new() -> Self {
        let mut ends = [TAIL; LAYERS];
        let mut heights = [exp(-0.5 * TAIL * TAIL).0; LAYERS];
        let mut inner = [0; LAYERS];
        for layer in (1..LAYERS - 1).rev() {
            let (end, height) = (ends[layer + 1], heights[layer + 1]);
            ends[layer] = (-2.0 * ln(AREA / end + height)).sqrt();
            heights[layer] = exp(-0.5 * ends[layer] * ends[layer]).0;
            if layer == 38 {
                // Almost halfway between two floats, of which NumPy's table has the other one.
                heights[layer] = heights[layer].next_up();
            }
            inner[layer + 1] = (ends[layer] / end * TWO_POW_52).round_ties_even() as u64;
        }
        inner[0] = (TAIL * heights[LAYERS - 1] / AREA * TWO_POW_52) as u64;
        (ends[0], heights[0]) = (AREA / heights[LAYERS - 1], 1.0);
        let widths = std::array::from_fn(|index| {
            let width = ends[index % LAYERS] / TWO_POW_52;
            if index < LAYERS { width } else { -width }
        });
        Self { widths, inner, heights }
    }
}

impl Pcg64 {
    /// A number from the standard normal distribution: `rng.standard_normal()`. `rng.normal(mean, deviation)` is
    /// `mean + deviation * rng.standard_normal()`.
    #[inline]
    pub fn standard_normal(&mut self) -> f64 {
        let ziggurat = &*ZIGGURAT;
        let word = self.next_u64();
        let layer = (word & 0xff) as usize;
        let coordinate = (word >> 9) & ((1 << 52) - 1);
        // The bit above those of the layer is the sign.
        let x = coordinate as f64 * ziggurat.widths[(word & 0x1ff) as usize];
        if coordinate < ziggurat.inner[layer] { x } else { self.beyond_inner_part(layer, coordinate, x) }
    }

    /// The cases of one draw in a hundred: the tail, the part of a layer above the density, or another attempt.
    #[cold]
    fn beyond_inner_part(&mut self, layer: usize, coordinate: u64, x: f64) -> f64 {
        if layer == 0 {
            loop {
                let beyond = -TAIL_INVERSE * (-self.random()).ln_1p();
                let height = -(-self.random()).ln_1p();
                if height + height > beyond * beyond {
                    return if coordinate >> 8 & 1 == 1 { -(TAIL + beyond) } else { TAIL + beyond };
                }
            }
        }
        let heights = &ZIGGURAT.heights;
        let height = (heights[layer - 1] - heights[layer]) * self.random() + heights[layer];
        if height < (-0.5 * x * x).exp() { x } else { self.standard_normal() }
    }
}

/// a + b, and its rounding error, where |a| ≥ |b|.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let rounded = a + b;
    (rounded, b - (rounded - a))
}

/// a · b as the sum of two floats (T. Dekker, 1971).
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let split = |x: f64| {
        let shifted = x * 134_217_729.0;
        let high = shifted - (shifted - x);
        (high, x - high)
    };
    let ((a_high, a_low), (b_high, b_low), rounded) = (split(a), split(b), a * b);
    (rounded, ((a_high * b_high - rounded) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

/// exp(x) for x in [-10, 10] as the sum of two floats, of which the first is the rounded value.
fn exp(x: f64) -> (f64, f64) {
    const HALVINGS: i32 = 10;
    let times = |(a, a_low): (f64, f64), (b, b_low): (f64, f64)| {
        let (high, low) = two_product(a, b);
        two_sum(high, low + (a * b_low + a_low * b))
    };
    // exp(y) = 1 + y (1 + y / 2 (1 + y / 3 (…))) with y = x / 2¹⁰, squared ten times.
    let y = (x / f64::from(1 << HALVINGS), 0.0);
    let mut value = (1.0, 0.0);
    for n in (1..=14).map(f64::from).rev() {
        let (high, low) = times(y, value);
        let quotient = high / n;
        let (back, back_low) = two_product(quotient, n);
        let remainder = ((high - back) - back_low + low) / n;
        let (one, rest) = two_sum(1.0, quotient);
        value = two_sum(one, rest + remainder);
    }
    (0..HALVINGS).fold(value, |root, _| times(root, root))
}

/// ln(x), rounded correctly: one step of Newton's method from the platform's value.
fn ln(x: f64) -> f64 {
    let first = x.ln();
    let (high, low) = exp(-first);
    let (one, rest) = two_product(x, high);
    first + ((one - 1.0) + (rest + x * low))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SeedSequence;

    #[test]
    fn the_first_draws_of_seed_0_match_numpy() {
        // np.random.default_rng(0).standard_normal(3)
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let drawn = [(); 3].map(|()| rng.standard_normal());
        assert_eq!(drawn, [0.125_730_221_093_393_3, -0.132_104_863_291_301_9, 0.640_422_650_443_282_1]);
    }

    #[test]
    fn the_moments_are_those_of_the_standard_normal_distribution() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let count = 400_000;
        let mut moments = [0.0; 4];
        for _ in 0..count {
            let x = rng.standard_normal();
            for (moment, power) in moments.iter_mut().zip(1..) {
                *moment += x.powi(power) / f64::from(count);
            }
        }
        // Within four standard errors.
        for (moment, (expected, variance)) in
            moments.into_iter().zip([(0.0, 1.0), (1.0, 2.0), (0.0, 15.0), (3.0, 96.0)])
        {
            assert!((moment - expected).abs() < 4.0 * f64::sqrt(variance / f64::from(count)), "{moments:?}");
        }
    }

    #[test]
    fn exponentials_and_logarithms_are_rounded_correctly() {
        assert_eq!(exp(1.0).0, std::f64::consts::E);
        assert_eq!(exp(-1.0).0 * std::f64::consts::E, 1.0);
        assert_eq!(ln(0.5), -std::f64::consts::LN_2);
    }
}
