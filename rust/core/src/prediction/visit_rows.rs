//! The features of states that have no numbers: those of the observations of an episode.

use super::RowSets;
use crate::memory::{AllocationError, RunMemory, reserve};

/// A method that looks back further than this keeps the rows of the whole episode.
const MOST_KEPT: usize = 1024;

/// The active rows of the states visited in this episode, which are numbered in the order of their visits.
#[derive(Clone, Debug, PartialEq)]
pub struct VisitRows {
    rows: Vec<u32>,
    n_active: usize,
    n_weights: usize,
    /// The number of states kept, a power of 2, less 1; `None` for the whole episode.
    mask: Option<u32>,
    last: u32,
}

impl VisitRows {
    /// Keeps the rows of the last state, the next one, and `look_back` before them; of all where it is `None`.
    ///
    /// # Errors
    /// `OutOfMemory`.
    pub fn new(n_active: usize, n_weights: usize, look_back: Option<usize>) -> Result<Self, AllocationError> {
        let kept = look_back.filter(|&count| count <= MOST_KEPT).map(|count| (count + 2).next_power_of_two());
        let mut rows = Vec::new();
        if let Some(kept) = kept {
            reserve(&mut rows, kept * n_active)?;
            rows.resize(kept * n_active, 0);
        }
        Ok(Self { rows, n_active, n_weights, mask: kept.map(|kept| kept as u32 - 1), last: 0 })
    }

    #[inline]
    fn store(&mut self, number: u32, active: &[u32]) -> u32 {
        if let Some(mask) = self.mask {
            self.rows[(number & mask) as usize * self.n_active..][..self.n_active].copy_from_slice(active);
        } else {
            self.rows.extend_from_slice(active);
        }
        self.last = number;
        number
    }
}

impl RowSets for VisitRows {
    #[inline]
    fn of(&self, state: u32) -> &[u32] {
        &self.rows[(state & self.mask.unwrap_or(u32::MAX)) as usize * self.n_active..][..self.n_active]
    }

    #[inline]
    fn n_active(&self) -> usize {
        self.n_active
    }

    fn n_weights(&self) -> usize {
        self.n_weights
    }

    #[inline]
    fn begin(&mut self, active: &[u32]) -> u32 {
        if self.mask.is_none() {
            self.rows.clear();
        }
        self.store(0, active)
    }

    #[inline]
    fn current(&self, _active: &[u32]) -> u32 {
        self.last
    }

    #[inline]
    fn visit_next(&mut self, active: &[u32]) -> u32 {
        self.store(self.last.wrapping_add(1), active)
    }

    fn reserve(&mut self, states: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        if self.mask.is_some() {
            return Ok(());
        }
        // Each call of the trainer may begin an episode.
        let states = usize::try_from(states).unwrap_or(usize::MAX).saturating_add(1);
        memory.reserve(&mut self.rows, states.saturating_mul(self.n_active))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_states_are_kept_and_all_of_them_where_a_method_needs_them() {
        for look_back in [Some(2), Some(MOST_KEPT + 1), None] {
            let mut rows = VisitRows::new(2, 100, look_back).expect("memory suffices");
            for episode in 0..2 {
                assert_eq!(rows.begin(&[episode, 50]), 0);
                for visit in 1..=40 {
                    assert_eq!(rows.current(&[]), visit - 1);
                    assert_eq!(rows.visit_next(&[episode + visit, 50 + visit]), visit);
                    for state in visit.saturating_sub(3)..=visit {
                        assert_eq!(rows.of(state), [episode + state, 50 + state]);
                    }
                }
                assert!(look_back == Some(2) || rows.of(1) == [episode + 1, 51]);
            }
        }
    }
}
