//! Gaussian radial basis functions (Sutton & Barto, section 9.5.5).

use std::marker::PhantomData;

use super::basis::features_of_basis;
use super::center_grid::CenterGrid;
use super::{FeatureVector, MAX_FEATURES};
use crate::errors::BuildError;
use crate::features::{Features, OutOfBounds};
use crate::numeric::Float;

/// The features xᵢ(s) = exp(-‖s - cᵢ‖² / 2σ²) around the centers cᵢ of a grid over a box, in C order. Components of
/// observations have the dtype `T` and are clipped to the box.
///
/// Distances are measured for each component in units of the distance between neighboring centers, so that σ, the width,
/// may differ between the components. A feature is computed as the product of the Gaussians of the components, from the
/// first to the last: exp(-0.5 (z z)) with z = (p - k) / σ, for the k-th center along the component and the position p = s
/// (n - 1) of a component s in [0, 1] among n centers.
///
/// Normalized features are divided by their sum, so that they sum to 1: the Gaussians of each component are, before they are
/// multiplied, by their sum from left to right. The exponential is that of the platform.
#[derive(Clone, Debug, PartialEq)]
pub struct RadialBasis<T = f64, const M: usize = MAX_FEATURES> {
    grid: CenterGrid,
    normalized: bool,
    dtype: PhantomData<T>,
}

/// The smallest and the largest width. Below, almost all observations would lie between the features.
const WIDTHS: [f64; 2] = [0.1, 1000.0];

impl<T: Float, const M: usize> RadialBasis<T, M> {
    /// The features over the box from `low` to `high`, with `centers` centers along each component, at least 2, the first at
    /// `low` and the last at `high`. `width` is σ along each component, in distances between neighboring centers.
    ///
    /// # Errors
    /// If the lengths differ, the bounds are not finite and in order, a component has fewer than 2 centers, a width is not
    /// in [0.1, 1000], or is more than 10 times the distance from the first center to the last, or there would be more than
    /// `M` features, or more than [`MAX_FEATURES`].
    pub fn try_new(
        low: &[f64],
        high: &[f64],
        centers: &[u32],
        width: &[f64],
        normalized: bool,
    ) -> Result<Self, BuildError> {
        let grid = CenterGrid::try_new((low, high), centers, ("width", width), M.min(MAX_FEATURES))?;
        for (&width, &count) in width.iter().zip(centers) {
            BuildError::check_number("width", WIDTHS[0], WIDTHS[1], width)?;
            let widest = 10.0 * f64::from(count - 1);
            let expected = format_args!("at most {widest} with {count} centers, beyond which features hardly differ");
            BuildError::check(width <= widest, "width", expected, width)?;
        }
        Ok(Self { grid, normalized, dtype: PhantomData })
    }

    /// The number of features.
    pub fn n_features(&self) -> usize {
        self.grid.len()
    }

    /// Writes the features of an observation.
    #[inline]
    pub(super) fn write(&self, observation: &[T], features: &mut [f64]) -> Result<(), OutOfBounds> {
        let gaussians = |numbers: &mut [f64]| {
            let mut sum = 0.0;
            for number in numbers.iter_mut() {
                *number = (-0.5 * (*number * *number)).exp();
                sum += *number;
            }
            if self.normalized {
                for number in numbers {
                    *number /= sum;
                }
            }
        };
        self.grid.write::<T, M>(observation, features, gaussians, |product, gaussian| product * gaussian)
    }
}

features_of_basis!(RadialBasis);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::ActiveFeatures;

    type Basis = RadialBasis<f64, 64>;

    fn values(basis: &Basis, observation: &[f64]) -> Vec<f64> {
        basis.active_rows(observation).expect("a finite observation").values().to_vec()
    }

    #[test]
    fn features_are_gaussians_of_the_distance_to_the_centers_of_a_grid() {
        let basis = Basis::try_new(&[0.0, -1.0], &[4.0, 1.0], &[5, 3], &[0.5, 2.0], false).expect("a basis");
        let (x, y) = (1.3, 0.4);
        let features = values(&basis, &[x, y]);
        assert_eq!(features.len(), 15);
        for (index, &feature) in features.iter().enumerate() {
            // Neighboring centers are 1 apart along both components.
            let (center_x, center_y) = ((index / 3) as f64, (index % 3) as f64 - 1.0);
            let squared = ((x - center_x) / 0.5).powi(2) + ((y - center_y) / 2.0).powi(2);
            assert!((feature - (-squared / 2.0).exp()).abs() < 1e-14, "{feature}");
        }
    }

    #[test]
    fn normalized_features_sum_to_one_and_keep_their_ratios() {
        let new = |normalized| Basis::try_new(&[0.0; 2], &[1.0; 2], &[4, 7], &[0.3, 1.0], normalized).expect("a basis");
        let (plain, normalized) = (values(&new(false), &[0.12, 0.9]), values(&new(true), &[0.12, 0.9]));
        let sum: f64 = plain.iter().sum();
        assert!((normalized.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        for (plain, normalized) in plain.iter().zip(&normalized) {
            assert!((plain / sum - normalized).abs() < 1e-15);
        }
    }

    #[test]
    fn the_narrowest_features_are_finite_between_the_centers() {
        let basis = Basis::try_new(&[0.0], &[1.0], &[40], &[0.1], true).expect("a basis");
        let features = values(&basis, &[0.5 / 39.0]);
        assert!((features[0] - 0.5).abs() < 1e-12 && (features[1] - 0.5).abs() < 1e-12, "{features:?}");
    }

    #[test]
    fn an_invalid_basis_is_refused_by_name() {
        let error = |centers: &[u32], width: &[f64]| {
            let refused = Basis::try_new(&[0.0; 2], &[1.0; 2], centers, width, false);
            refused.expect_err("an invalid basis").to_string()
        };
        assert_eq!(error(&[3, 3], &[0.0, 1.0]), "width must be a number in [0.1, 1000], got 0");
        assert!(error(&[3, 3], &[1.0, f64::NAN]).starts_with("width must be a number"));
        let wide = "width must be at most 10 with 2 centers, beyond which features hardly differ, got 11";
        assert_eq!(error(&[3, 2], &[11.0, 11.0]), wide);
    }
}
