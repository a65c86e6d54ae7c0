//! `Features` for a basis.

/// Implements [`Features`](crate::features::Features) for a type `$basis<T, M>` with its methods `n_features` and `write`,
/// and one that returns the divisors of the step sizes, if these differ. Components of observations have the dtype `T`, and
/// there is room for `M` features.
macro_rules! features_of_basis {
    ($basis:ident $(, $divisors:ident)?) => {
        impl<T: Float, O: AsRef<[T]> + ?Sized, const M: usize> Features<O> for $basis<T, M> {
            type Active = FeatureVector<M>;

            #[inline]
            fn active_rows(&self, observation: &O) -> Result<FeatureVector<M>, OutOfBounds> {
                let Some(mut features) = FeatureVector::zeros(self.n_features()) else {
                    unreachable!("the constructor has checked the capacity")
                };
                self.write(observation.as_ref(), features.values_mut())?;
                Ok(features)
            }

            #[inline]
            fn write_active_rows(&self, observation: &O, active: &mut FeatureVector<M>) -> Result<(), OutOfBounds> {
                self.write(observation.as_ref(), active.values_mut())
            }

            fn len(&self) -> usize {
                self.n_features()
            }

            $(fn step_size_divisors(&self) -> Vec<f64> {
                self.$divisors()
            })?
        }
    };
}

pub(super) use features_of_basis;
