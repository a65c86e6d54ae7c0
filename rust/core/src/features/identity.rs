//! Discrete observations as row indices.

use super::{Features, OutOfBounds};

/// Discrete observations as row indices; the field is their number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity(pub u32);

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_observation_has_a_row_and_a_larger_one_has_none() {
        assert_eq!(Identity(3).active_rows(&2), Ok([2]));
        assert!(Identity(3).active_rows(&3).is_err());
    }
}
