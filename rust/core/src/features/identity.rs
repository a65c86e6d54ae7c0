//! A discrete observation is its own row; of several numbers each combination has one.

use super::{Features, Outside};

/// One row for each of so many observations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity(pub u32);

impl Features<u32> for Identity {
    type Rows = [u32; 1];

    #[inline]
    fn rows(&self, &observation: &u32) -> Result<[u32; 1], Outside> {
        if observation < self.0 { Ok([observation]) } else { Err(Outside { axis: 0, value: f64::from(observation) }) }
    }

    fn len(&self) -> usize {
        self.0 as usize
    }
}

/// One row for each combination of numbers below so many each, the last one running fastest: `np.ravel_multi_index`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cells<C>(pub C);

impl<C: AsRef<[u32]>> Features<[u32]> for Cells<C> {
    type Rows = [u32; 1];

    #[inline]
    fn rows(&self, observation: &[u32]) -> Result<[u32; 1], Outside> {
        let mut row = 0;
        for (axis, (&number, &count)) in observation.iter().zip(self.0.as_ref()).enumerate() {
            if number >= count {
                return Err(Outside { axis, value: f64::from(number) });
            }
            row = row * count + number;
        }
        Ok([row])
    }

    fn len(&self) -> usize {
        self.0.as_ref().iter().map(|&count| count as usize).product()
    }
}

impl<const N: usize> Features<[u32; N]> for Cells<[u32; N]> {
    type Rows = [u32; 1];

    #[inline]
    fn rows(&self, observation: &[u32; N]) -> Result<[u32; 1], Outside> {
        self.rows(observation.as_slice())
    }

    fn len(&self) -> usize {
        Features::<[u32]>::len(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_observation_has_a_row_and_the_next_has_none() {
        assert_eq!(Identity(3).rows(&2), Ok([2]));
        assert!(Identity(3).rows(&3).is_err());
    }

    #[test]
    fn combinations_are_counted_in_c_order() {
        let cells = Cells([2, 3, 4]);
        assert_eq!(Features::<[u32]>::len(&cells), 24);
        assert_eq!(cells.rows(&[0, 0, 3]), Ok([3]));
        assert_eq!(cells.rows(&[1, 2, 3]), Ok([23]));
        assert_eq!(cells.rows(&[1, 3, 0]), Err(Outside { axis: 1, value: 3.0 }));
    }
}
