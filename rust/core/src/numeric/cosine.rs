//! What a step needs of the platform's cosine, for several steps at once, and without its bits depending on how.
//!
//! A monotone function `f` of the cosine is wanted, such as the next velocity. The cosine is computed as a sum of two
//! numbers, `near + tail`, far closer to the true value than the platform's rounded one. glibc promises that one to
//! within 0.55 units in the last place. So it is what `near + (tail ± bound)` rounds to, one way or the other, and
//! where `f` gives the same bits for both and for `near`, it gives them for the platform's cosine too. Elsewhere (one
//! step in twenty) the platform is asked.

#![expect(clippy::inline_always, reason = "what is compiled for each instruction set must be inlined to be so")]

/// Cells of 1/64, from 0 to 4.
const CELLS: usize = 256;
const PER_UNIT: i128 = 64;
/// Larger angles than this go to the platform.
const LARGEST: f64 = 3.99;

/// The table's numbers are computed with this many bits after the point.
const FRACTION: u32 = 110;
const ONE: i128 = 1 << FRACTION;
/// The sine's head has so few bits that its product with the rest of an angle is exact.
const HEAD: u32 = 7;

/// Cosine and sine in the middle of each cell: head and tail of the one, head and tail of the other.
static TABLE: [[f64; 4]; CELLS] = {
    let mut table = [[0.0; 4]; CELLS];
    let mut cell = 0;
    while cell < CELLS {
        let (cos, sin) = cos_sin(cell as i128);
        let cos_head = cos as f64;
        let sin_head = (sin + (ONE >> (HEAD + 1))) >> (FRACTION - HEAD) << (FRACTION - HEAD);
        table[cell] = [
            cos_head / ONE as f64,
            (cos - cos_head as i128) as f64 / ONE as f64,
            sin_head as f64 / ONE as f64,
            (sin - sin_head) as f64 / ONE as f64,
        ];
        cell += 1;
    }
    table
};

/// Cosine and sine of `cell / PER_UNIT`, in units of 2⁻¹¹⁰, by their series.
const fn cos_sin(cell: i128) -> (i128, i128) {
    let (mut cos, mut sin) = (0, 0);
    let mut term = ONE;
    let mut power = 0;
    while term != 0 {
        match power % 4 {
            0 => cos += term,
            1 => sin += term,
            2 => cos -= term,
            _ => sin -= term,
        }
        power += 1;
        term = term * cell / (PER_UNIT * power);
    }
    (cos, sin)
}

/// Adding this rounds to a whole number of cells, and leaves that number in the low bits.
const ROUND_TO_CELL: f64 = 6_755_399_441_055_744.0 / PER_UNIT as f64; // 1.5 × 2⁵²
const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
/// What glibc's bound leaves beyond half a unit in the last place of a number between 1 and 2 …
const BEYOND_HALF_ULP: f64 = 0.05 * f64::EPSILON;
/// … and the error of `near + tail`: its terms of 2⁻¹⁵ are rounded four times, the series ends below 2⁻⁷⁰.
const APPROXIMATION_ERROR: f64 = 1.0 / 36_893_488_147_419_103_232.0; // 2⁻⁶⁵

/// Whether the promise that all this rests on is given here.
pub(crate) const IS_EXACT: bool = cfg!(all(target_os = "linux", target_env = "gnu"));

/// Puts `f(lane, angles[lane].cos())` into `values`, with the bits that the platform's cosine gives. `f` must be
/// monotone in the cosine.
#[inline(always)]
pub(crate) fn map_cos<const K: usize>(angles: &[f64; K], f: impl Fn(usize, f64) -> f64, values: &mut [f64; K]) {
    let mut rests = [0.0; K];
    let mut entries = [[0.0; K]; 4];
    for lane in 0..K {
        let angle = angles[lane].abs();
        let shifted = angle + ROUND_TO_CELL;
        rests[lane] = angle - (shifted - ROUND_TO_CELL);
        let entry = &TABLE[shifted.to_bits() as usize % CELLS];
        for (column, number) in entries.iter_mut().zip(entry) {
            column[lane] = *number;
        }
    }
    let mut uncertain = [0; K];
    for lane in 0..K {
        let (cos, cos_tail) = (entries[0][lane], entries[1][lane]);
        let (sin, sin_tail) = (entries[2][lane], entries[3][lane]);
        let rest = rests[lane];
        let square = rest * rest;
        let cube = rest * square;
        // 1 - cos(rest) and rest - sin(rest)
        let versed = square * 0.5 - square * square * (1.0 / 24.0 - square * (1.0 / 720.0));
        let missing = cube * (1.0 / 6.0) - cube * square * (1.0 / 120.0 - square * (1.0 / 5040.0));
        let main = cos - sin * rest;
        let small = ((sin + sin_tail) * missing - sin_tail * rest) - cos * versed;
        let hi = main + small;
        let lo = ((main - hi) + small) + (((cos - main) - sin * rest) + cos_tail);
        let bound = f64::from_bits(hi.to_bits() & EXPONENT) * BEYOND_HALF_ULP + APPROXIMATION_ERROR;
        let value = f(lane, hi);
        values[lane] = value;
        let bits = value.to_bits();
        uncertain[lane] = (f(lane, hi + (lo - bound)).to_bits() ^ bits)
            | (f(lane, hi + (lo + bound)).to_bits() ^ bits)
            | u64::from(angles[lane].abs() > LARGEST);
    }
    if uncertain.iter().fold(0, |all, doubt| all | doubt) != 0 {
        for lane in 0..K {
            if uncertain[lane] != 0 {
                values[lane] = f(lane, platform(angles[lane]));
            }
        }
    }
}

#[cold]
#[inline(never)]
fn platform(angle: f64) -> f64 {
    angle.cos()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The velocity after a step, and steeper functions that let more of the cosine's last bits through.
    fn check(angle: f64, velocity: f64, gravity: f64) {
        let f = |_, cosine: f64| velocity + cosine * -gravity;
        let mut values = [0.0; 2];
        map_cos(&[angle, -angle], f, &mut values);
        assert_eq!(values[0].to_bits(), f(0, angle.cos()).to_bits(), "cos({angle:?})");
        assert_eq!(values[1].to_bits(), f(0, (-angle).cos()).to_bits(), "cos(-{angle:?})");
    }

    #[test]
    fn zeros_and_the_edges_of_cells_are_the_platforms() {
        use std::f64::consts::{FRAC_PI_2, PI};
        for center in (0..=256).map(|cell| f64::from(cell) / 128.0 * 2.0).chain([FRAC_PI_2, PI, LARGEST, 1e9]) {
            for offset in [0.0, 1.0 / 128.0, -1.0 / 128.0, 1e-17, -1e-12, 1e-300] {
                for gravity in [0.0025, 1.0, 1e6] {
                    check(center + offset, 0.01, gravity);
                    check(center + offset, 0.0, gravity);
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200_000))]

        #[test]
        fn the_bits_are_the_platforms(
            angle in prop_oneof![-4.0..4.0, any::<f64>().prop_filter("finite", |angle| angle.is_finite())],
            velocity in prop_oneof![-0.07..0.07, Just(0.0)],
            gravity in prop_oneof![Just(0.0025), -2.0..2.0],
        ) {
            check(angle, velocity, gravity);
        }
    }
}
