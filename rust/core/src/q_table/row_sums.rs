//! Sums over active rows, from left to right (Sutton & Barto, equation 9.8).

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

/// The sums of the values of all actions, in registers.
#[inline(always)]
pub(crate) fn sum_rows<const A: usize>(mut rows: impl Iterator<Item = [f64; A]>) -> [f64; A] {
    let mut sums = rows.next().unwrap_or([0.0; A]);
    for values in rows {
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += value;
        }
    }
    sums
}

/// The sum of the values of one action.
#[inline(always)]
pub(crate) fn sum_values(mut values: impl Iterator<Item = f64>) -> f64 {
    let first = values.next().unwrap_or(0.0);
    values.fold(first, |sum, value| sum + value)
}
