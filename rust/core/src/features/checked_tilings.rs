//! Tile coding with checked arguments.

use super::TileCoding;
use crate::errors::BuildError;
use crate::numeric::Float;

impl<T: Float> TileCoding<T> {
    /// `tilings` tilings of the box from `low` to `high`, with `tiles` tiles along each component. Observations are
    /// clipped to the box.
    ///
    /// # Errors
    /// If the slices have different lengths or are empty, a bound is not finite, `high` is not above `low`, a component
    /// has no tiles, `tilings` is 0 or greater than [`MAX_TILINGS`](super::MAX_TILINGS), or the table would have 2³² rows or more.
    pub fn try_new(low: &[f64], high: &[f64], tiles: &[u32], tilings: u32) -> Result<Self, BuildError> {
        Self::try_with_capacity(low, high, tiles, tilings)
    }
}

impl<T: Float, const M: usize> TileCoding<T, M> {
    /// As [`try_new`](TileCoding::try_new), with room for `M` tilings. Active rows are copied at every step, so a smaller
    /// capacity is faster.
    ///
    /// # Errors
    /// As for `try_new`.
    pub fn try_with_capacity(low: &[f64], high: &[f64], tiles: &[u32], tilings: u32) -> Result<Self, BuildError> {
        for (setting, len) in [("high", high.len()), ("tiles", tiles.len())] {
            BuildError::check(len == low.len(), setting, format_args!("of the length of low, {}", low.len()), len)?;
        }
        BuildError::check(!low.is_empty(), "low", "the bounds of at least one component", "none")?;
        let has_room = (1..=M).contains(&(tilings as usize));
        BuildError::check(has_room, "tilings", format_args!("a number in [1, {M}]"), tilings)?;
        for (component, &tiles) in tiles.iter().enumerate() {
            let got = format_args!("{tiles} for component {component}");
            BuildError::check((1..u32::MAX).contains(&tiles), "tiles", "numbers from 1 to 2**32 - 2", got)?;
        }
        let rows = tiles.iter().try_fold(u64::from(tilings), |rows, &tiles| rows.checked_mul(u64::from(tiles) + 1));
        let fits = rows.is_some_and(|rows| u32::try_from(rows).is_ok());
        let expected = "few enough for a table of less than 2**32 rows";
        BuildError::check(fits, "tiles", expected, format_args!("{tiles:?}"))?;
        check_bounds(low.iter().copied().zip(high.iter().copied()))?;
        Ok(Self::new(low, high, tiles, tilings))
    }
}

/// Checks that each component has finite bounds in order.
pub(super) fn check_bounds(bounds: impl Iterator<Item = (f64, f64)>) -> Result<(), BuildError> {
    for (component, (low, high)) in bounds.enumerate() {
        let got = format_args!("{high} above {low} for component {component}");
        BuildError::check(low.is_finite() && high.is_finite() && low < high, "high", "finite and above low", got)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::Features;

    #[test]
    fn invalid_tilings_are_refused_by_name() {
        let error = |low: &[f64], high: &[f64], tiles: &[u32], tilings| {
            let refused = TileCoding::<f64, 8>::try_with_capacity(low, high, tiles, tilings);
            refused.expect_err("invalid tilings").to_string()
        };
        let backwards = "high must be finite and above low, got 0 above 1 for component 0";
        assert_eq!(error(&[1.0], &[0.0], &[4], 8), backwards);
        assert_eq!(error(&[0.0], &[1.0, 2.0], &[4], 8), "high must be of the length of low, 1, got 2");
        assert_eq!(error(&[0.0], &[1.0], &[0], 8), "tiles must be numbers from 1 to 2**32 - 2, got 0 for component 0");
        assert_eq!(error(&[0.0], &[1.0], &[4], 9), "tilings must be a number in [1, 8], got 9");
        assert!(error(&[0.0; 9], &[1.0; 9], &[99; 9], 8).contains("less than 2**32 rows"));
        assert!(error(&[], &[], &[], 1).starts_with("low must"));
        assert!(error(&[0.0], &[f64::NAN], &[4], 1).starts_with("high must"));
        assert!(TileCoding::<f64>::try_new(&[0.0], &[1.0], &[4], 8).is_ok());
        let unchecked = TileCoding::<f64, 8>::new(&[1.0], &[0.0], &[4], 8);
        assert_eq!(Features::<[f64]>::check(&unchecked).map_err(|error| error.to_string()), Err(backwards.into()));
    }
}
