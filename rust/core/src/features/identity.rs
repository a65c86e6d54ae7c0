//! Discrete observations as row indices.

use super::{Features, OutOfBounds};

/// Discrete observations, `u32` or `usize`, as row indices; the field is their number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity(pub u32);

impl Identity {
    /// The number of observations, each of which has a row of the table.
    pub fn n_rows(&self) -> usize {
        self.0 as usize
    }
}

impl Features<u32> for Identity {
    type Active = [u32; 1];

    #[inline]
    fn active_rows(&self, &observation: &u32) -> Result<[u32; 1], OutOfBounds> {
        if observation < self.0 {
            Ok([observation])
        } else {
            Err(OutOfBounds { axis: 0, value: f64::from(observation) })
        }
    }

    fn len(&self) -> usize {
        self.0 as usize
    }
}

impl Features<usize> for Identity {
    type Active = [u32; 1];

    #[inline]
    fn active_rows(&self, &observation: &usize) -> Result<[u32; 1], OutOfBounds> {
        match u32::try_from(observation) {
            Ok(row) if row < self.0 => Ok([row]),
            _ => Err(OutOfBounds { axis: 0, value: observation as f64 }),
        }
    }

    fn len(&self) -> usize {
        self.0 as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_observation_has_a_row_and_a_larger_one_has_none() {
        assert_eq!(Identity(3).active_rows(&2_u32), Ok([2]));
        assert!(Identity(3).active_rows(&3_u32).is_err());
        assert_eq!(Identity(3).active_rows(&2_usize), Ok([2]));
        assert_eq!(Identity(3).active_rows(&(1_usize << 32)), Err(OutOfBounds { axis: 0, value: 4_294_967_296.0 }));
    }
}
