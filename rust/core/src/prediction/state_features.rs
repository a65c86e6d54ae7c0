//! The features of states: the active rows of each.

use crate::memory::{AllocationError, RunMemory, collect, reserve};

/// A method that looks back further than this stores the rows of the whole episode.
const MOST_KEPT: usize = 1024;

/// The active rows of states, the same number for each. A method identifies a state by its number.
#[derive(Debug, PartialEq)]
pub struct StateFeatures {
    rows: Vec<u32>,
    n_active: usize,
    n_weights: usize,
    /// `None` for states that the task numbers: the active row in the task is then the number of a state.
    visits: Option<Visits>,
}

/// The visits of an episode, which number states that have no numbers of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Visits {
    /// The number of states stored; `None` for the whole episode.
    kept: Option<u32>,
    /// The number of the state visited last.
    last: u32,
}

impl StateFeatures {
    /// The features of numbered states: a table, state aggregation, tile coding. `rows` holds `n_active` rows for each
    /// state, those of state 0 first, each less than `n_weights`; `None` if it does not.
    pub fn of_states(rows: Vec<u32>, n_active: usize, n_weights: usize) -> Option<Self> {
        let fits =
            n_active > 0 && rows.len().is_multiple_of(n_active) && rows.iter().all(|&row| (row as usize) < n_weights);
        fits.then_some(Self { rows, n_active, n_weights, visits: None })
    }

    /// The features of states without numbers: those of the observations of an episode. Stores the rows of the last
    /// state, the next one, and `look_back` states before them; `None` stores all.
    ///
    /// # Errors
    /// `OutOfMemory`.
    pub fn of_visits(n_active: usize, n_weights: usize, look_back: Option<usize>) -> Result<Self, AllocationError> {
        let kept = look_back.filter(|&count| count <= MOST_KEPT).map(|count| count as u32 + 2);
        let (mut rows, count) = (Vec::new(), kept.map_or(0, |kept| kept as usize * n_active));
        reserve(&mut rows, count)?;
        rows.resize(count, 0);
        Ok(Self { rows, n_active, n_weights, visits: Some(Visits { kept, last: 0 }) })
    }

    /// A copy.
    ///
    /// # Errors
    /// `OutOfMemory`.
    pub fn try_clone(&self) -> Result<Self, AllocationError> {
        Ok(Self { rows: collect(self.rows.iter().copied())?, ..*self })
    }

    /// The number of states; 0 if they are not numbered.
    pub fn num_states(&self) -> usize {
        if self.visits.is_some() { 0 } else { self.rows.len() / self.n_active }
    }

    /// The number of active rows of a state.
    #[inline]
    pub fn n_active(&self) -> usize {
        self.n_active
    }

    /// The number of weights.
    pub fn n_weights(&self) -> usize {
        self.n_weights
    }

    /// The active rows of a state.
    #[inline]
    pub fn of(&self, state: u32) -> &[u32] {
        &self.rows[state as usize * self.n_active..][..self.n_active]
    }

    /// The row of a state with one active row; the first row otherwise.
    #[inline]
    pub fn first(&self, state: u32) -> usize {
        self.rows[state as usize * self.n_active] as usize
    }

    /// Begins an episode.
    pub(super) fn begin(&mut self) {
        let Some(visits) = &mut self.visits else { return };
        visits.last = u32::MAX;
        if visits.kept.is_none() {
            self.rows.clear();
        }
    }

    /// The number of the next state of the episode, given its active rows in the task.
    pub(super) fn visit(&mut self, active: &[u32]) -> u32 {
        let Some(Visits { kept, last }) = &mut self.visits else { return active[0] };
        *last = last.wrapping_add(1);
        if let Some(kept) = *kept {
            *last = if *last == kept { 0 } else { *last };
            self.rows[*last as usize * self.n_active..][..self.n_active].copy_from_slice(active);
        } else {
            self.rows.extend_from_slice(active);
        }
        *last
    }

    /// Reserves memory for this many more states.
    ///
    /// # Errors
    /// `OutOfMemory`, `LimitReached`.
    pub(super) fn reserve(&mut self, states: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        let Some(Visits { kept: None, .. }) = self.visits else { return Ok(()) };
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
            let mut features = StateFeatures::of_visits(2, 100, look_back).expect("memory suffices");
            for episode in 0..2 {
                features.begin();
                let mut states = vec![features.visit(&[episode, 50])];
                for visit in 1..=40 {
                    states.push(features.visit(&[episode + visit, 50 + visit]));
                    for visit in visit.saturating_sub(3)..=visit {
                        assert_eq!(features.of(states[visit as usize]), [episode + visit, 50 + visit]);
                    }
                }
                assert!(look_back == Some(2) || features.of(states[1]) == [episode + 1, 51]);
            }
        }
    }
}
