//! Sums in a fixed order.

/// The sum from left to right, starting with the first number, so that its bits do not depend on the machine.
/// (`np.sum` adds pairwise and would round differently.)
#[inline]
pub(crate) fn sum(mut numbers: impl Iterator<Item = f64>) -> f64 {
    let first = numbers.next().unwrap_or(0.0);
    numbers.fold(first, |total, number| total + number)
}
