//! The actions that are available in each state.

use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::memory::{AllocationError, filled};

/// The action masks of the states, each as last reported. With one active row per state, there is a mask for each row;
/// with several, as in tile coding, only that of the last state.
#[derive(Clone, Debug, PartialEq)]
pub struct ActionMasks {
    num_actions: usize,
    /// The distance between the masks of two rows; 0 if there is only one mask.
    stride: usize,
    available: Vec<bool>,
    /// A buffer for masked values.
    values: Vec<f64>,
}

impl ActionMasks {
    /// Masks for a table with `rows` rows, with every action available.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn new(rows: usize, num_actions: usize, n_active: usize, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        let (masks, stride) = if n_active == 1 { (rows, num_actions) } else { (1, 0) };
        let available = filled(&true, masks * num_actions, stop)?;
        Ok(Self { num_actions, stride, available, values: vec![0.0; num_actions] })
    }

    /// Known masks, row by row.
    pub fn known(available: Vec<bool>, num_actions: usize) -> Self {
        Self { num_actions, stride: num_actions, available, values: vec![0.0; num_actions] }
    }

    /// All masks, row by row.
    pub fn available(&self) -> &[bool] {
        &self.available
    }

    /// Replaces the mask of a state.
    pub fn set(&mut self, rows: &[u32], mask: &[bool]) {
        let start = self.start(rows);
        self.available[start..][..self.num_actions].copy_from_slice(mask);
    }

    /// The action values of a state, with -∞ for unavailable actions.
    pub fn masked(&mut self, rows: &[u32], values: &[f64]) -> &[f64] {
        let start = self.start(rows);
        let available = &self.available[start..][..self.num_actions];
        for ((masked, &value), &available) in self.values.iter_mut().zip(values).zip(available) {
            *masked = if available { value } else { f64::NEG_INFINITY };
        }
        &self.values
    }

    #[inline]
    fn start(&self, rows: &[u32]) -> usize {
        rows.first().map_or(0, |&row| row as usize) * self.stride
    }
}

impl Persist for ActionMasks {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.available.persist(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_has_the_mask_that_was_set_last() {
        let mut masks = ActionMasks::new(2, 2, 1, &StopFlag::new()).expect("a few masks");
        masks.set(&[1], &[true, false]);
        assert_eq!(masks.masked(&[0], &[1.0, 2.0]), [1.0, 2.0]);
        assert_eq!(masks.masked(&[1], &[1.0, 2.0]), [1.0, f64::NEG_INFINITY]);
        masks.set(&[1], &[false, true]);
        assert_eq!(masks.masked(&[1], &[1.0, 2.0]), [f64::NEG_INFINITY, 2.0]);
    }

    #[test]
    fn tile_coding_has_the_mask_of_the_last_state() {
        let mut masks = ActionMasks::new(9, 2, 3, &StopFlag::new()).expect("one mask");
        masks.set(&[2, 5, 8], &[false, true]);
        assert_eq!(masks.masked(&[2, 5, 7], &[1.0, 2.0]), [f64::NEG_INFINITY, 2.0]);
        assert_eq!(masks.available(), [false, true]);
    }
}
