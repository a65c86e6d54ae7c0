//! What both forms of the cosine are computed from: cells of angles, and cosine and sine in the middle of a cell.

/// Angles from -4 to 4 are divided into cells of width 1/64.
pub(super) const CELLS_PER_UNIT: i128 = 64;
/// The number of cells from 0 to 4.
pub(super) const CELLS: usize = 256;

/// The number of fractional bits of the fixed-point numbers that the table is computed with.
pub(super) const FRACTION: u32 = 110;
pub(super) const ONE: i128 = 1 << FRACTION;

/// Adding this rounds an angle to a whole number of cells and leaves that number in the low bits of the sum, negative
/// ones in two's complement.
pub(super) const ROUND_TO_CELL: f64 = 6_755_399_441_055_744.0 / CELLS_PER_UNIT as f64; // 1.5 × 2⁵²

/// Cosine and sine of `cell / CELLS_PER_UNIT` by their Taylor series, in units of 2⁻¹¹⁰. Each of some 60 terms is cut
/// off by less than a unit. `cell` may be negative.
pub(super) const fn cos_sin(cell: i128) -> (i128, i128) {
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
        term = term * cell / (CELLS_PER_UNIT * power);
    }
    (cos, sin)
}
