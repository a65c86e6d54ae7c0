//! Weighted features chosen at run time.

use super::basis::features_of_basis;
use super::{CoarseCoding, FeatureVector, FourierBasis, MAX_FEATURES, PolynomialBasis, RadialBasis};
use crate::features::{Features, OutOfBounds};
use crate::numeric::Float;

/// One of the kinds of weighted features, chosen at run time.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyBasis<T = f64, const M: usize = MAX_FEATURES> {
    /// Cosines.
    Fourier(FourierBasis<T, M>),
    /// Products of powers.
    Polynomial(PolynomialBasis<T, M>),
    /// Gaussians around centers.
    Radial(RadialBasis<T, M>),
    /// Receptive fields around centers.
    Coarse(CoarseCoding<T, M>),
}

impl<T: Float, const M: usize> AnyBasis<T, M> {
    /// The number of features.
    pub fn n_features(&self) -> usize {
        match self {
            Self::Fourier(basis) => basis.n_features(),
            Self::Polynomial(basis) => basis.n_features(),
            Self::Radial(basis) => basis.n_features(),
            Self::Coarse(basis) => basis.n_features(),
        }
    }

    /// [`Features::step_size_divisors`].
    pub fn divisors(&self) -> Vec<f64> {
        match self {
            Self::Fourier(basis) => basis.divisors(),
            Self::Polynomial(_) | Self::Radial(_) | Self::Coarse(_) => Vec::new(),
        }
    }

    /// Writes the features of an observation. It is not inlined, so that it is not compiled again for each task.
    #[inline(never)]
    fn write(&self, observation: &[T], features: &mut [f64]) -> Result<(), OutOfBounds> {
        match self {
            Self::Fourier(basis) => basis.write(observation, features),
            Self::Polynomial(basis) => basis.write(observation, features),
            Self::Radial(basis) => basis.write(observation, features),
            Self::Coarse(basis) => basis.write(observation, features),
        }
    }
}

features_of_basis!(AnyBasis, divisors);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::ActiveFeatures;

    #[test]
    fn a_basis_chosen_at_run_time_has_the_features_of_its_kind() {
        const LOW: [f64; 2] = [-1.2, -0.07];
        const HIGH: [f64; 2] = [0.6, 0.07];
        fn check<B>(basis: B, any: impl FnOnce(B) -> AnyBasis<f32, 64>)
        where
            B: Features<[f32; 2], Active = FeatureVector<64>> + Clone,
        {
            let any = any(basis.clone());
            let observation = [-0.5, 0.01];
            let features = basis.active_rows(&observation).expect("a finite observation");
            assert_eq!(any.active_rows(&observation), Ok(features));
            let mut written = FeatureVector::zeros(any.n_features()).expect("room for the features");
            assert_eq!(any.write_active_rows(&observation, &mut written), Ok(()));
            assert_eq!(written.values(), features.values());
            assert!(features.values().iter().any(|&feature| feature != 0.0));
            assert_eq!(any.divisors(), basis.step_size_divisors());
            assert_eq!(any.active_rows(&[f32::NAN, 0.0]).map_err(|error| error.axis).err(), Some(0));
        }
        check(FourierBasis::try_new(&LOW, &HIGH, 3, true, true).expect("a basis"), AnyBasis::Fourier);
        check(PolynomialBasis::try_new(&LOW, &HIGH, 3, false).expect("a basis"), AnyBasis::Polynomial);
        check(RadialBasis::try_new(&LOW, &HIGH, &[4, 3], &[1.0; 2], true).expect("a basis"), AnyBasis::Radial);
        check(CoarseCoding::try_new(&LOW, &HIGH, &[4, 3], &[1.5; 2]).expect("circles"), AnyBasis::Coarse);
    }
}
