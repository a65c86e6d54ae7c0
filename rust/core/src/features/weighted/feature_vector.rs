//! The values of the features of an observation, one for each row of the table.

use super::super::ActiveFeatures;

/// The maximum number of weighted features.
pub const MAX_FEATURES: usize = 1024;

/// The rows of weighted features: every row is active.
static ROWS: [u32; MAX_FEATURES] = {
    let mut rows = [0; MAX_FEATURES];
    let mut row = 0;
    while row < MAX_FEATURES {
        rows[row] = row as u32;
        row += 1;
    }
    rows
};

/// The values xᵢ(s) of the features of an observation: feature i belongs to row i. `M` is the capacity, at most
/// [`MAX_FEATURES`]: a state takes the memory of `M` values, so a smaller capacity is faster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureVector<const M: usize = MAX_FEATURES> {
    values: [f64; M],
    len: u32,
}

impl<const M: usize> FeatureVector<M> {
    /// The features with these values; `None` for more than `M`, or more than [`MAX_FEATURES`].
    pub fn new(values: &[f64]) -> Option<Self> {
        let mut features = Self::zeros(values.len())?;
        features.values_mut().copy_from_slice(values);
        Some(features)
    }

    /// `len` features that are 0; `None` for more than `M`, or more than [`MAX_FEATURES`].
    pub fn zeros(len: usize) -> Option<Self> {
        (len <= M.min(MAX_FEATURES)).then_some(Self { values: [0.0; M], len: len as u32 })
    }

    /// The values, mutable.
    #[inline]
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values[..self.len as usize]
    }
}

impl<const M: usize> AsRef<[u32]> for FeatureVector<M> {
    #[inline(always)]
    fn as_ref(&self) -> &[u32] {
        &ROWS[..self.len as usize]
    }
}

impl<const M: usize> ActiveFeatures for FeatureVector<M> {
    const WEIGHTED: bool = true;

    #[inline(always)]
    fn values(&self) -> &[f64] {
        &self.values[..self.len as usize]
    }

    fn from_values(values: &[f64]) -> Option<Self> {
        Self::new(values)
    }
}

/// Rows alone are not the features of an observation, so there is no conversion from them.
impl<const M: usize> TryFrom<&[u32]> for FeatureVector<M> {
    type Error = ();

    fn try_from(_rows: &[u32]) -> Result<Self, ()> {
        Err(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_feature_has_the_row_of_its_number() {
        let Some(features) = FeatureVector::<4>::new(&[0.5, -1.0, 2.0]) else { unreachable!("there is room") };
        assert_eq!(features.as_ref(), [0, 1, 2]);
        assert_eq!(features.values(), [0.5, -1.0, 2.0]);
        assert_eq!(FeatureVector::from_values(features.values()), Some(features));
    }

    #[test]
    fn more_features_than_the_capacity_are_refused() {
        assert_eq!(FeatureVector::<2>::new(&[0.0; 3]), None);
        assert_eq!(FeatureVector::<2000>::new(&[0.0; MAX_FEATURES + 1]), None);
    }
}
