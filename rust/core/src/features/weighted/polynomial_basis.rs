//! Polynomials as features (Sutton & Barto, section 9.5.1).

use std::marker::PhantomData;

use super::basis::features_of_basis;
use super::combinations::Combinations;
use super::multi_indices::MultiIndices;
use super::scaled_box::ScaledBox;
use super::{FeatureVector, MAX_FEATURES};
use crate::errors::BuildError;
use crate::features::{Features, OutOfBounds};
use crate::numeric::Float;

/// The features xᵢ(s) = Πⱼ sⱼ^cᵢⱼ of states s that are scaled to [0, 1]: component j of an observation o of dtype `T` becomes
/// sⱼ = (oⱼ - lowⱼ) / (highⱼ - lowⱼ), in f64, after o is clipped to the bounds.
///
/// The exponents are integers from 0 to the order n. Coupled features have all (n + 1)ᵈ combinations of exponents, in C order,
/// so that x₁ = 1 and x₂ is the last component. Others are the constant 1, then the powers 1 to n of the first component,
/// and so on.
///
/// Powers are running products, s, s s, (s s) s, …, and products of powers run from the first component to the last.
#[derive(Clone, Debug, PartialEq)]
pub struct PolynomialBasis<T = f64, const M: usize = MAX_FEATURES> {
    scaled: ScaledBox,
    exponents: MultiIndices,
    /// The powers 0 to n of each component.
    powers: Combinations,
    dtype: PhantomData<T>,
}

impl<T: Float, const M: usize> PolynomialBasis<T, M> {
    /// The features of order `order`, at least 1, over the box from `low` to `high`.
    ///
    /// # Errors
    /// If the bounds differ in length or are not finite and in order, `order` is 0, or there would be more than `M`
    /// features, or more than [`MAX_FEATURES`].
    pub fn try_new(low: &[f64], high: &[f64], order: u32, coupled: bool) -> Result<Self, BuildError> {
        let scaled = ScaledBox::try_new(low, high)?;
        let exponents = MultiIndices::try_new(low.len(), order, coupled, M.min(MAX_FEATURES))?;
        // Uncoupled features do not combine the powers, so their number of combinations does not matter.
        let components = if coupled { low.len() } else { 1 };
        let powers = Combinations::new(vec![exponents.order() + 1; components], usize::MAX);
        let Some(powers) = powers else { unreachable!("they are as many as the features") };
        Ok(Self { scaled, exponents, powers, dtype: PhantomData })
    }

    /// The number of features.
    pub fn n_features(&self) -> usize {
        self.exponents.len()
    }

    /// Writes the features of an observation.
    #[inline]
    pub(super) fn write(&self, observation: &[T], features: &mut [f64]) -> Result<(), OutOfBounds> {
        if !self.exponents.is_coupled() {
            return self.scaled.write_uncoupled(self.exponents.order(), observation, features, write_powers_from_one);
        }
        let write_powers = |_, s, powers: &mut [f64]| {
            powers[0] = 1.0;
            write_powers_from_one(s, &mut powers[1..]);
        };
        self.powers.write::<T, M>(&self.scaled, observation, features, write_powers, |product, power| product * power)
    }
}

/// Writes s, s², s³, ….
#[inline]
fn write_powers_from_one(s: f64, powers: &mut [f64]) {
    let mut product = s;
    for power in powers {
        *power = product;
        product *= s;
    }
}

features_of_basis!(PolynomialBasis);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::ActiveFeatures;

    fn values(dimensions: usize, order: u32, coupled: bool, observation: &[f64]) -> Vec<f64> {
        let basis =
            PolynomialBasis::<f64, 64>::try_new(&vec![-1.0; dimensions], &vec![3.0; dimensions], order, coupled);
        let basis = basis.expect("a basis");
        let features = basis.active_rows(observation).expect("a finite observation");
        assert_eq!(features.values().len(), basis.n_features());
        features.values().to_vec()
    }

    #[test]
    fn coupled_features_are_all_products_of_powers() {
        // The observations are scaled to 0.5 and 0.25.
        let expected = [1.0, 0.25, 0.0625, 0.5, 0.125, 0.03125, 0.25, 0.0625, 0.015_625];
        assert_eq!(values(2, 2, true, &[1.0, 0.0]), expected);
        assert_eq!(values(1, 20, true, &[1.0])[20], 0.5_f64.powi(20));
    }

    #[test]
    fn uncoupled_features_are_the_powers_of_single_components() {
        assert_eq!(values(2, 3, false, &[1.0, 0.0]), [1.0, 0.5, 0.25, 0.125, 0.25, 0.0625, 0.015_625]);
        assert_eq!(values(3, 20, false, &[1.0, 0.0, 3.0]).len(), 61);
    }

    #[test]
    fn observations_are_clipped_to_the_bounds() {
        assert_eq!(values(2, 1, true, &[f64::INFINITY, -9.0]), [1.0, 0.0, 1.0, 0.0]);
    }

    #[test]
    fn an_invalid_basis_is_refused_by_name() {
        let error = |high: f64, order| {
            let refused = PolynomialBasis::<f64, 64>::try_new(&[0.0; 2], &[1.0, high], order, true);
            refused.expect_err("an invalid basis").to_string()
        };
        assert_eq!(error(1.0, 8), "order must be small enough for 64 features, got 8 with 2 components");
        assert_eq!(error(1.0, 0), "order must be at least 1, got 0");
        assert!(error(f64::INFINITY, 1).starts_with("high must be finite"));
    }
}
