//! The Fourier basis (G. Konidaris, S. Osentoski and P. Thomas, 2011; Sutton & Barto, section 9.5.2).

use std::marker::PhantomData;

use super::basis::features_of_basis;
use super::combinations::SMALL;
use super::complex_powers::{Powers, write_real_products, write_row};
use super::multi_indices::MultiIndices;
use super::scaled_box::ScaledBox;
use super::{FeatureVector, MAX_FEATURES};
use crate::errors::BuildError;
use crate::features::{Features, OutOfBounds};
use crate::numeric::Float;

/// The features xᵢ(s) = cos(π cⁱ·s) of states s that are scaled to [0, 1]: component j of an observation o of dtype `T`
/// becomes sⱼ = (oⱼ - lowⱼ) / (highⱼ - lowⱼ), in f64, after o is clipped to the bounds.
///
/// The components of a frequency vector cⁱ are integers from 0 to the order n. Coupled features have all (n + 1)ᵈ vectors, in
/// C order, so that c¹ = 0 and c² = (0, …, 0, 1). Others have the d n + 1 vectors with at most one component that is not
/// 0: the zero vector, then those of the first component, and so on.
///
/// The cosine of a sum is computed by the addition theorem, from the powers z⁰, …, zⁿ of e^(iπsⱼ) = cos πsⱼ + i sin πsⱼ of
/// each component: zᵏ = zᵏ⁻ᵐ zᵐ with m = ⌊k/2⌋, and xᵢ is the real part of the product of the powers from the first
/// component to the last. Two calls of the platform for each component replace one for each feature; the last bits may differ
/// from those of cos(π cⁱ·s).
#[derive(Clone, Debug, PartialEq)]
pub struct FourierBasis<T = f64, const M: usize = MAX_FEATURES> {
    scaled: ScaledBox,
    frequencies: MultiIndices,
    scales_step_sizes: bool,
    /// Whether there are at most [`SMALL`] powers and as many of their products, as for up to 16² features of two
    /// components.
    is_small: bool,
    dtype: PhantomData<T>,
}

impl<T: Float, const M: usize> FourierBasis<T, M> {
    /// The features of order `order`, at least 1, over the box from `low` to `high`. `scales_step_sizes` divides the
    /// learning rate of each feature by the Euclidean length of its frequency vector, where this is not 0.
    ///
    /// # Errors
    /// If the bounds differ in length or are not finite and in order, `order` is 0, or there would be more than `M`
    /// features, or more than [`MAX_FEATURES`].
    pub fn try_new(
        low: &[f64],
        high: &[f64],
        order: u32,
        coupled: bool,
        scales_step_sizes: bool,
    ) -> Result<Self, BuildError> {
        let scaled = ScaledBox::try_new(low, high)?;
        let frequencies = MultiIndices::try_new(low.len(), order, coupled, M.min(MAX_FEATURES))?;
        let powers = frequencies.order() + 1;
        let is_small = powers <= SMALL && (!coupled || frequencies.len() / powers <= SMALL);
        Ok(Self { scaled, frequencies, scales_step_sizes, is_small, dtype: PhantomData })
    }

    /// The number of features.
    pub fn n_features(&self) -> usize {
        self.frequencies.len()
    }

    /// [`Features::step_size_divisors`].
    pub fn divisors(&self) -> Vec<f64> {
        if !self.scales_step_sizes {
            return Vec::new();
        }
        self.frequency_lengths().into_iter().map(|length| if length == 0.0 { 1.0 } else { length }).collect()
    }

    /// The Euclidean length of the frequency vector of each feature, in their order.
    fn frequency_lengths(&self) -> Vec<f64> {
        self.frequencies.squared_lengths().map(|square| (square as f64).sqrt()).collect()
    }

    /// Writes the features of an observation.
    #[inline]
    pub(super) fn write(&self, observation: &[T], features: &mut [f64]) -> Result<(), OutOfBounds> {
        match (self.frequencies.is_coupled(), self.is_small) {
            (true, true) => self.write_coupled::<SMALL>(observation, features),
            (true, false) => self.write_coupled::<M>(observation, features),
            (false, true) => self.write_uncoupled::<SMALL>(observation, features),
            (false, false) => self.write_uncoupled::<M>(observation, features),
        }
    }

    /// The features with at most one component of the frequency vector that is not 0.
    #[inline]
    fn write_uncoupled<const P: usize>(&self, observation: &[T], features: &mut [f64]) -> Result<(), OutOfBounds> {
        let order = self.frequencies.order();
        let mut powers = Powers::<P>::new();
        self.scaled.write_uncoupled(order, observation, features, |s, features| {
            powers.compute(s, order + 1);
            features.copy_from_slice(&powers.re[1..=order]);
        })
    }

    /// The features with all frequency vectors: the products of the first components grow by one component at a time.
    #[inline]
    fn write_coupled<const P: usize>(&self, observation: &[T], features: &mut [f64]) -> Result<(), OutOfBounds> {
        let count = self.frequencies.order() + 1;
        let (mut powers, mut products) = (Powers::<P>::new(), Powers::<P>::new());
        let last = self.scaled.dimensions() - 1;
        let mut len = 1;
        for (axis, &value) in observation.iter().enumerate() {
            let scaled = self.scaled.scale(axis, value.into())?;
            if axis == 0 {
                products.compute(scaled, count);
                len = count;
                continue;
            }
            powers.compute(scaled, count);
            let (re, im) = (&powers.re[..count], &powers.im[..count]);
            if axis == last {
                // Orders up to 7 with constants, for vector registers.
                match count {
                    2 => write_real_products::<2, P>(features, &products, re, im),
                    3 => write_real_products::<3, P>(features, &products, re, im),
                    4 => write_real_products::<4, P>(features, &products, re, im),
                    5 => write_real_products::<5, P>(features, &products, re, im),
                    6 => write_real_products::<6, P>(features, &products, re, im),
                    7 => write_real_products::<7, P>(features, &products, re, im),
                    8 => write_real_products::<8, P>(features, &products, re, im),
                    _ => {
                        for (index, features) in features.chunks_exact_mut(count).enumerate() {
                            write_row(features, (products.re[index], products.im[index]), re, im);
                        }
                    }
                }
                return Ok(());
            }
            // From the last product, because the new ones overwrite those after it.
            for index in (0..len).rev() {
                let (product_re, product_im) = (products.re[index], products.im[index]);
                let range = index * count..(index + 1) * count;
                let new = products.re[range.clone()].iter_mut().zip(&mut products.im[range]);
                for ((new_re, new_im), (re, im)) in new.zip(re.iter().zip(im)) {
                    *new_re = product_re * re - product_im * im;
                    *new_im = product_re * im + product_im * re;
                }
            }
            len *= count;
        }
        features.copy_from_slice(&products.re[..features.len()]);
        Ok(())
    }
}

features_of_basis!(FourierBasis, divisors);

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::features::ActiveFeatures;

    fn basis(dimensions: usize, order: u32, coupled: bool) -> FourierBasis<f64, 256> {
        FourierBasis::try_new(&vec![-1.0; dimensions], &vec![3.0; dimensions], order, coupled, true).expect("a basis")
    }

    fn values(basis: &FourierBasis<f64, 256>, observation: &[f64]) -> Vec<f64> {
        basis.active_rows(observation).expect("a finite observation").values().to_vec()
    }

    fn check_close(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-13, "{found} {expected}");
        }
    }

    #[test]
    fn coupled_features_are_the_cosines_of_all_frequency_vectors_in_c_order() {
        for dimensions in 1..=3_u32 {
            let order = 5;
            let basis = basis(dimensions as usize, order, true);
            let s: Vec<f64> = (0..dimensions).map(|axis| 0.13 + 0.29 * f64::from(axis)).collect();
            let observation: Vec<f64> = s.iter().map(|s| -1.0 + 4.0 * s).collect();
            let count = order + 1;
            let expected: Vec<f64> = (0..count.pow(dimensions))
                .map(|index| {
                    let c = (0..dimensions).map(|axis| index / count.pow(dimensions - 1 - axis) % count);
                    (PI * c.zip(&s).map(|(c, s)| f64::from(c) * s).sum::<f64>()).cos()
                })
                .collect();
            check_close(&values(&basis, &observation), &expected);
        }
    }

    #[test]
    fn uncoupled_features_are_the_cosines_of_single_components() {
        let basis = basis(2, 3, false);
        let cos = |c: f64, s: f64| (PI * c * s).cos();
        let expected = [1.0, cos(1.0, 0.1), cos(2.0, 0.1), cos(3.0, 0.1), cos(1.0, 0.7), cos(2.0, 0.7), cos(3.0, 0.7)];
        check_close(&values(&basis, &[-0.6, 1.8]), &expected);
        assert_eq!(basis.frequency_lengths(), [0.0, 1.0, 2.0, 3.0, 1.0, 2.0, 3.0]);
    }

    #[test]
    fn step_sizes_are_divided_by_the_length_of_the_frequency_vector() {
        let basis = basis(2, 2, true);
        let (two, five, eight) = (2.0_f64.sqrt(), 5.0_f64.sqrt(), 8.0_f64.sqrt());
        assert_eq!(basis.frequency_lengths(), [0.0, 1.0, 2.0, 1.0, two, five, 2.0, five, eight]);
        assert_eq!(basis.divisors()[..2], [1.0, 1.0]);
    }

    #[test]
    fn observations_are_clipped_to_the_bounds_and_nan_is_refused() {
        let basis = basis(2, 2, true);
        assert_eq!(values(&basis, &[-9.0, f64::INFINITY]), values(&basis, &[-1.0, 3.0]));
        let refused = basis.active_rows(&[0.0, f64::NAN]).map_err(|error| error.axis);
        assert_eq!(refused.map(|features| features.values().len()), Err(1));
    }

    #[test]
    fn an_invalid_basis_is_refused_by_name() {
        let error = |low: &[f64], high: &[f64], order, coupled| {
            let refused = FourierBasis::<f64, 64>::try_new(low, high, order, coupled, true);
            refused.expect_err("an invalid basis").to_string()
        };
        assert_eq!(error(&[0.0], &[1.0], 0, true), "order must be at least 1, got 0");
        let large = "order must be small enough for 64 features, got 8 with 2 components";
        assert_eq!(error(&[0.0; 2], &[1.0; 2], 8, true), large);
        assert!(error(&[0.0; 2], &[1.0; 2], u32::MAX, false).starts_with("order must"));
        assert!(error(&[0.0; 2], &[1.0, f64::INFINITY], 1, true).starts_with("high must be finite"));
        assert!(error(&[0.0; 2], &[1.0], 1, true).starts_with("high must be of the length of low"));
    }
}
