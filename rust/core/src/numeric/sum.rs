//! Sums whose bits do not depend on the machine.

/// The sum from left to right, starting with the first number. (`np.sum` adds pairwise and would round differently.)
#[inline(always)]
pub(crate) fn sum(mut numbers: impl Iterator<Item = f64>) -> f64 {
    let first = numbers.next().unwrap_or(0.0);
    numbers.fold(first, |total, number| total + number)
}
