//! The vectors of integers that number the features of a basis.

use crate::errors::BuildError;

/// The vectors of `dimensions` integers from 0 to the order n, such as frequencies or exponents.
///
/// Coupled ones are all (n + 1)ᵈ, in C order, so that the first is 0 and the second (0, …, 0, 1). Others are the d n + 1 with
/// at most one component that is not 0: the zero vector, then those of the first component, and so on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct MultiIndices {
    dimensions: usize,
    order: usize,
    coupled: bool,
    len: usize,
}

impl MultiIndices {
    /// # Errors
    /// If `order` is 0, or there would be more than `most` vectors.
    pub(super) fn try_new(dimensions: usize, order: u32, coupled: bool, most: usize) -> Result<Self, BuildError> {
        BuildError::check(order > 0, "order", "at least 1", order)?;
        let len = count(dimensions, order as usize, coupled).filter(|&len| len <= most);
        let Some(len) = len else {
            let expected = format_args!("small enough for {most} features");
            return Err(BuildError::invalid("order", expected, format_args!("{order} with {dimensions} components")));
        };
        Ok(Self { dimensions, order: order as usize, coupled, len })
    }

    pub(super) fn order(&self) -> usize {
        self.order
    }

    pub(super) fn is_coupled(&self) -> bool {
        self.coupled
    }

    /// The number of vectors.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The sum of the squares of the components of each vector, in their order.
    pub(super) fn squared_lengths(&self) -> impl Iterator<Item = usize> {
        let Self { dimensions, order, coupled, len } = *self;
        (0..len).map(move |index| {
            if coupled {
                let mut rest = index;
                (0..dimensions).fold(0, |sum, _| {
                    let component = rest % (order + 1);
                    rest /= order + 1;
                    sum + component * component
                })
            } else {
                let component = index.checked_sub(1).map_or(0, |index| index % order + 1);
                component * component
            }
        })
    }
}

/// The number of vectors; `None` if it is too large to count.
fn count(dimensions: usize, order: usize, coupled: bool) -> Option<usize> {
    if coupled {
        order.checked_add(1)?.checked_pow(u32::try_from(dimensions).ok()?)
    } else {
        dimensions.checked_mul(order)?.checked_add(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn squares(dimensions: usize, order: u32, coupled: bool) -> Vec<usize> {
        MultiIndices::try_new(dimensions, order, coupled, 64).expect("few vectors").squared_lengths().collect()
    }

    #[test]
    fn the_vectors_are_those_of_all_components_or_of_single_ones() {
        assert_eq!(squares(2, 2, true), [0, 1, 4, 1, 2, 5, 4, 5, 8]);
        assert_eq!(squares(2, 3, false), [0, 1, 4, 9, 1, 4, 9]);
        assert_eq!(squares(1, 2, true), squares(1, 2, false));
    }

    #[test]
    fn invalid_orders_are_refused_by_name() {
        let error = |dimensions, order, coupled| {
            MultiIndices::try_new(dimensions, order, coupled, 64).expect_err("an invalid order").to_string()
        };
        assert_eq!(error(1, 0, true), "order must be at least 1, got 0");
        assert_eq!(error(2, 8, true), "order must be small enough for 64 features, got 8 with 2 components");
        assert_eq!(error(2, 32, false), "order must be small enough for 64 features, got 32 with 2 components");
        assert!(error(2, u32::MAX, false).starts_with("order must be small enough"));
        assert!(error(99, u32::MAX, true).starts_with("order must be small enough"));
    }
}
