//! Observations of several discrete numbers as row indices.

use super::{Features, OutOfBounds};

/// One row for each combination of discrete numbers, in C order: `np.ravel_multi_index`. The field holds the number of
/// values that each of them can take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MultiDiscreteIndex<C>(pub C);

impl<C: AsRef<[u32]>> MultiDiscreteIndex<C> {
    /// The number of combinations, each of which has a row of the table.
    pub fn n_rows(&self) -> usize {
        Features::<[u32]>::len(self)
    }
}

impl<C: AsRef<[u32]>, O: AsRef<[u32]> + ?Sized> Features<O> for MultiDiscreteIndex<C> {
    type Active = [u32; 1];

    #[inline]
    fn active_rows(&self, observation: &O) -> Result<[u32; 1], OutOfBounds> {
        let mut row = 0;
        for (axis, (&number, &count)) in observation.as_ref().iter().zip(self.0.as_ref()).enumerate() {
            if number >= count {
                return Err(OutOfBounds { axis, value: f64::from(number) });
            }
            row = row * count + number;
        }
        Ok([row])
    }

    fn len(&self) -> usize {
        self.0.as_ref().iter().map(|&count| count as usize).product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn combinations_are_in_c_order() {
        let index = MultiDiscreteIndex([2, 3, 4]);
        assert_eq!(index.n_rows(), 24);
        assert_eq!(index.active_rows(&[0, 0, 3]), Ok([3]));
        assert_eq!(index.active_rows(&[1, 2, 3]), Ok([23]));
        assert_eq!(index.active_rows(&[1, 3, 0]), Err(OutOfBounds { axis: 1, value: 3.0 }));
    }
}
