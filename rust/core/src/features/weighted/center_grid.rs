//! Features around the centers of a grid.

use super::combinations::Combinations;
use super::scaled_box::ScaledBox;
use crate::errors::BuildError;
use crate::features::OutOfBounds;
use crate::numeric::Float;

/// A grid of centers over a box, the first of each component at its lower bound and the last at its upper bound, with the
/// extent of the features around them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CenterGrid {
    scaled: ScaledBox,
    centers: Combinations,
    /// The extent of a feature along each component, in distances between neighboring centers.
    extent: Vec<f64>,
}

impl CenterGrid {
    /// `extent` is the name of the setting and its numbers, one for each component.
    ///
    /// # Errors
    /// If the lengths differ, the bounds are not finite and in order, a component has fewer than 2 centers, or there would
    /// be more than `most` centers.
    pub(super) fn try_new(
        (low, high): (&[f64], &[f64]),
        centers: &[u32],
        (setting, extent): (&'static str, &[f64]),
        most: usize,
    ) -> Result<Self, BuildError> {
        let scaled = ScaledBox::try_new(low, high)?;
        for (setting, len) in [("centers", centers.len()), (setting, extent.len())] {
            BuildError::check(len == low.len(), setting, format_args!("of the length of low, {}", low.len()), len)?;
        }
        let enough = centers.iter().all(|&count| count >= 2);
        BuildError::check(enough, "centers", "at least 2 along each component", format_args!("{centers:?}"))?;
        let counts = centers.iter().map(|&count| count as usize).collect();
        let Some(grid) = Combinations::new(counts, most) else {
            let expected = format_args!("few enough for {most} features");
            return Err(BuildError::invalid("centers", expected, format_args!("{centers:?}")));
        };
        Ok(Self { scaled, centers: grid, extent: extent.to_vec() })
    }

    /// The number of centers.
    pub(super) fn len(&self) -> usize {
        self.centers.len()
    }

    /// Writes a number for each center. `along_axis` receives the distances of an observation from the centers along a
    /// component, in units of the extent, and turns them into the numbers that `combine` combines from the first component
    /// to the last. `M` is at least [`len`](Self::len).
    #[inline]
    pub(super) fn write<T: Float, const M: usize>(
        &self,
        observation: &[T],
        features: &mut [f64],
        along_axis: impl Fn(&mut [f64]),
        combine: impl Fn(f64, f64) -> f64,
    ) -> Result<(), OutOfBounds> {
        let write_numbers = |axis: usize, s: f64, numbers: &mut [f64]| {
            let (position, extent) = (s * (numbers.len() - 1) as f64, self.extent[axis]);
            for (index, number) in numbers.iter_mut().enumerate() {
                *number = (position - index as f64) / extent;
            }
            along_axis(numbers);
        };
        self.centers.write::<T, M>(&self.scaled, observation, features, write_numbers, combine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_counted_in_extents_between_neighboring_centers() {
        let grid =
            CenterGrid::try_new((&[0.0, 10.0], &[1.0, 14.0]), &[2, 3], ("width", &[0.5, 2.0]), 64).expect("a grid");
        let mut features = [f64::NAN; 6];
        grid.write::<f64, 64>(&[0.25, 13.0], &mut features, |_| (), |first, _| first).expect("no NaN");
        assert_eq!(features, [0.5, 0.5, 0.5, -1.5, -1.5, -1.5]);
        grid.write::<f64, 64>(&[0.25, 13.0], &mut features, |_| (), |_, second| second).expect("no NaN");
        assert_eq!(features, [0.75, 0.25, -0.25, 0.75, 0.25, -0.25]);
    }

    #[test]
    fn invalid_grids_are_refused_by_name() {
        let error = |high: f64, centers: &[u32], extent: &[f64]| {
            let refused = CenterGrid::try_new((&[0.0; 2], &[1.0, high]), centers, ("radius", extent), 64);
            refused.expect_err("an invalid grid").to_string()
        };
        assert_eq!(error(1.0, &[3], &[1.0; 2]), "centers must be of the length of low, 2, got 1");
        assert_eq!(error(1.0, &[3; 2], &[1.0]), "radius must be of the length of low, 2, got 1");
        assert_eq!(error(1.0, &[3, 1], &[1.0; 2]), "centers must be at least 2 along each component, got [3, 1]");
        assert_eq!(error(1.0, &[9, 8], &[1.0; 2]), "centers must be few enough for 64 features, got [9, 8]");
        assert!(error(f64::NAN, &[3; 2], &[1.0; 2]).starts_with("high must be finite"));
    }
}
