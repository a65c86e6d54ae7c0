//! The maximum of some values, and its index.

/// The index of the maximum, and of the first one if several are equal: `np.argmax` of values without NaN. With NaN the
/// index is unspecified: a table with NaN has diverged, and its run ends. [`argmax_with_nan`] takes NaN.
///
/// # Panics
/// If there are no values.
#[inline]
pub fn argmax(values: &[f64]) -> usize {
    // The pairs carry the value: looking it up by index would add a load to the chain of comparisons.
    let better = |one: (usize, f64), other: (usize, f64)| if other.1 > one.1 { other } else { one };
    let mut best = (0, values[0]);
    if values.len() < 4 {
        for (index, &value) in values.iter().enumerate().skip(1) {
            best = better(best, (index, value));
        }
        return best.0;
    }
    // Comparing pairs first shortens the chain of dependent comparisons.
    for (pair, values) in values.chunks(2).enumerate() {
        let first = (2 * pair, values[0]);
        let of_pair = if let &[_, second] = values { better(first, (2 * pair + 1, second)) } else { first };
        best = if pair == 0 { of_pair } else { better(best, of_pair) };
    }
    best.0
}

/// `np.argmax`: the index of the first NaN, or of the first maximum if there is none.
///
/// # Panics
/// If there are no values.
pub fn argmax_with_nan(values: &[f64]) -> usize {
    values.iter().position(|value| value.is_nan()).unwrap_or_else(|| argmax(values))
}

/// The maximum: `np.max` of values without NaN. With NaN it is unspecified.
#[inline]
pub(crate) fn maximum(values: &[f64]) -> f64 {
    values[1..].iter().fold(values[0], |largest, &value| if value > largest { value } else { largest })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_equal_maxima_wins() {
        assert_eq!(argmax(&[1.0, 3.0, 3.0]), 1);
        assert_eq!(argmax(&[0.0, -0.0]), 0);
        assert_eq!(maximum(&[-2.0, -1.0, -3.0]), -1.0);
    }

    #[test]
    fn the_first_nan_is_the_maximum_as_in_numpy() {
        assert_eq!(argmax_with_nan(&[1.0, f64::NAN, f64::INFINITY, f64::NAN]), 1);
        assert_eq!(argmax_with_nan(&[f64::NEG_INFINITY, 3.0, 3.0]), 1);
    }
}
