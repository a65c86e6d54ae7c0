//! Coarse coding (Sutton & Barto, section 9.5.3).

use std::marker::PhantomData;

use super::basis::features_of_basis;
use super::center_grid::CenterGrid;
use super::{FeatureVector, MAX_FEATURES};
use crate::errors::BuildError;
use crate::features::{Features, OutOfBounds};
use crate::numeric::Float;

/// Features that are 1 within their receptive field and 0 outside. The receptive fields are intervals of one component,
/// circles of two, and balls of more, around the centers of a grid over a box, in C order. Components of observations have
/// the dtype `T` and are clipped to the box.
///
/// Distances are measured for each component in units of the distance between neighboring centers, so that the radius r may
/// differ between the components: the circles are then ellipses. A feature is 1 if the sum of z z over the components, from
/// the first to the last, is at most 1, with z = (p - k) / r for the k-th center along the component and the position p = s
/// (n - 1) of a component s in [0, 1] among n centers.
///
/// The number of active features varies between observations, so they are weighted features, of which each is 0 or 1.
#[derive(Clone, Debug, PartialEq)]
pub struct CoarseCoding<T = f64, const M: usize = MAX_FEATURES> {
    grid: CenterGrid,
    dtype: PhantomData<T>,
}

impl<T: Float, const M: usize> CoarseCoding<T, M> {
    /// The features over the box from `low` to `high`, with `centers` centers along each component, at least 2, the first at
    /// `low` and the last at `high`. `radius` is the radius of a receptive field along each component, in distances between
    /// neighboring centers.
    ///
    /// # Errors
    /// If the lengths differ, the bounds are not finite and in order, a component has fewer than 2 centers, some
    /// observation would lie in no receptive field, or every receptive field would contain the whole box, or there would be
    /// more than `M` features, or more than [`MAX_FEATURES`].
    pub fn try_new(low: &[f64], high: &[f64], centers: &[u32], radius: &[f64]) -> Result<Self, BuildError> {
        let grid = CenterGrid::try_new((low, high), centers, ("radius", radius), M.min(MAX_FEATURES))?;
        let is_finite = radius.iter().all(|&radius| radius.is_finite() && radius > 0.0);
        BuildError::check(is_finite, "radius", "finite numbers above 0", format_args!("{radius:?}"))?;
        // The sum of squares from left to right, for distances along the components in units between centers.
        let squared = |distance: fn(u32) -> f64| {
            let along = radius.iter().zip(centers).map(|(radius, &count)| distance(count) / radius);
            along.fold(0.0, |sum, z| sum + z * z)
        };
        let covers = squared(|_| 0.5) <= 1.0;
        let expected = "large enough that every observation lies within a receptive field";
        BuildError::check(covers, "radius", expected, format_args!("{radius:?}"))?;
        let differ = squared(|count| f64::from(count - 1)) > 1.0;
        let expected = "small enough that not every receptive field contains the whole box";
        BuildError::check(differ, "radius", expected, format_args!("{radius:?}"))?;
        Ok(Self { grid, dtype: PhantomData })
    }

    /// The number of features.
    pub fn n_features(&self) -> usize {
        self.grid.len()
    }

    /// Writes the features of an observation.
    #[inline]
    pub(super) fn write(&self, observation: &[T], features: &mut [f64]) -> Result<(), OutOfBounds> {
        let square = |numbers: &mut [f64]| numbers.iter_mut().for_each(|number| *number *= *number);
        self.grid.write::<T, M>(observation, features, square, |sum, square| sum + square)?;
        for feature in features {
            *feature = if *feature <= 1.0 { 1.0 } else { 0.0 };
        }
        Ok(())
    }
}

features_of_basis!(CoarseCoding);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::ActiveFeatures;

    fn values<const M: usize>(coding: &CoarseCoding<f64, M>, observation: &[f64]) -> Vec<f64> {
        coding.active_rows(observation).expect("a finite observation").values().to_vec()
    }

    #[test]
    fn intervals_overlap_along_one_component() {
        let coding = CoarseCoding::<f64, 8>::try_new(&[0.0], &[4.0], &[5], &[1.5]).expect("intervals");
        assert_eq!(values(&coding, &[0.0]), [1.0, 1.0, 0.0, 0.0, 0.0]);
        assert_eq!(values(&coding, &[1.5]), [1.0, 1.0, 1.0, 1.0, 0.0]);
        assert_eq!(values(&coding, &[1.6]), [0.0, 1.0, 1.0, 1.0, 0.0]);
        assert_eq!(values(&coding, &[99.0]), [0.0, 0.0, 0.0, 1.0, 1.0]);
    }

    #[test]
    fn circles_contain_what_is_nearer_than_their_radius() {
        let coding = CoarseCoding::<f64, 16>::try_new(&[0.0; 2], &[3.0; 2], &[4, 4], &[1.0, 1.0]).expect("circles");
        for (x, y) in [(0.0, 0.0), (1.2, 1.9), (2.7, 0.4), (3.0, 3.0)] {
            let expected: Vec<f64> = (0..16)
                .map(|index| {
                    let (center_x, center_y) = (f64::from(index / 4), f64::from(index % 4));
                    let distance = f64::hypot(x - center_x, y - center_y);
                    if distance < 1.0 + 1e-12 { 1.0 } else { 0.0 }
                })
                .collect();
            assert_eq!(values(&coding, &[x, y]), expected);
            assert!(expected.contains(&1.0));
        }
    }

    #[test]
    fn invalid_radii_are_refused_by_name() {
        let error = |radius: &[f64]| {
            let refused = CoarseCoding::<f64, 64>::try_new(&[0.0; 2], &[1.0; 2], &[3, 5], radius);
            refused.expect_err("an invalid radius").to_string()
        };
        assert!(error(&[0.7, 0.7]).starts_with("radius must be large enough that every observation"));
        assert!(error(&[9.0, 9.0]).starts_with("radius must be small enough that not every receptive field"));
        assert!(error(&[0.0, 1.0]).starts_with("radius must be finite numbers above 0, got [0.0, 1.0]"));
        assert!(error(&[f64::NAN, 1.0]).starts_with("radius must be finite"));
        assert!(CoarseCoding::<f64, 64>::try_new(&[0.0; 2], &[1.0; 2], &[3, 5], &[0.71, 0.71]).is_ok());
    }
}
