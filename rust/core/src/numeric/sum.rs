//! Sums whose bits do not depend on the machine.

/// The sum from left to right, starting with the first number. (`np.sum` adds pairwise and would round differently.)
#[inline(always)]
pub(crate) fn sum(mut numbers: impl Iterator<Item = f64>) -> f64 {
    let first = numbers.next().unwrap_or(0.0);
    numbers.fold(first, |total, number| total + number)
}

/// The number of partial sums of [`sum_products`].
const PARTS: usize = 4;

/// Σᵢ wᵢ xᵢ for `A` columns of weights at once: `weights` returns those of row i. There are four partial sums that begin at
/// 0, of the products 0, 4, 8, … and 1, 5, 9, … and so on, each from left to right; the result is (p₀ + p₁) + (p₂ + p₃). A
/// single sum would be a chain of additions that wait for each other.
#[inline(always)]
pub fn sum_products<const A: usize>(x: &[f64], weights: impl Fn(usize) -> [f64; A]) -> [f64; A] {
    let mut parts = [[0.0; A]; PARTS];
    let add = |part: &mut [f64; A], weights: [f64; A], x: f64| {
        for (sum, weight) in part.iter_mut().zip(weights) {
            *sum += weight * x;
        }
    };
    let (blocks, rest) = x.as_chunks::<PARTS>();
    for (block, x) in blocks.iter().enumerate() {
        for (index, part) in parts.iter_mut().enumerate() {
            add(part, weights(PARTS * block + index), x[index]);
        }
    }
    for ((index, part), &x) in parts.iter_mut().enumerate().zip(rest) {
        add(part, weights(PARTS * blocks.len() + index), x);
    }
    add_parts(parts)
}

/// [`sum_products`] with a row of weights for each feature; `pick` takes `A` columns of a row. Whole blocks of rows are read
/// without a check of their bounds, and the products of a block fit into vector registers.
#[inline(always)]
pub(crate) fn sum_row_products<const N: usize, const A: usize>(
    x: &[f64],
    rows: &[[f64; N]],
    pick: impl Fn(&[f64; N]) -> [f64; A],
) -> [f64; A] {
    let mut parts = [[0.0; A]; PARTS];
    let add = |parts: &mut [[f64; A]; PARTS], x: &[f64], rows: &[[f64; N]]| {
        for (part, (x, row)) in parts.iter_mut().zip(x.iter().zip(rows)) {
            for (sum, weight) in part.iter_mut().zip(pick(row)) {
                *sum += weight * x;
            }
        }
    };
    let ((blocks, x), (row_blocks, rows)) = (x.as_chunks::<PARTS>(), rows.as_chunks::<PARTS>());
    for (x, rows) in blocks.iter().zip(row_blocks) {
        add(&mut parts, x, rows);
    }
    add(&mut parts, x, rows);
    add_parts(parts)
}

/// The sums of the four partial sums of each column.
#[inline(always)]
fn add_parts<const A: usize>(parts: [[f64; A]; PARTS]) -> [f64; A] {
    std::array::from_fn(|column| (parts[0][column] + parts[1][column]) + (parts[2][column] + parts[3][column]))
}
