//! Sums in a stated order.

/// From the left, beginning with the first.
#[inline]
pub(crate) fn sum(mut numbers: impl Iterator<Item = f64>) -> f64 {
    let first = numbers.next().unwrap_or(0.0);
    numbers.fold(first, |total, number| total + number)
}
