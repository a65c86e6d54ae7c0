//! The state-action pairs that a model predicts to lead to each state.

use crate::StopFlag;
use crate::memory::{AllocationError, check_indices, filled};

/// Marks the end of a list and a pair that is in no list.
const NONE: u32 = u32::MAX;

/// A doubly linked list of pairs for each row.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::learners) struct Predecessors {
    /// The first pair of each row.
    first: Vec<u32>,
    /// The pairs after and before each pair.
    links: Vec<[u32; 2]>,
}

impl Predecessors {
    /// Empty lists.
    pub(in crate::learners) fn new(rows: usize, pairs: usize, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        check_indices(rows.max(pairs))?;
        Ok(Self { first: filled(&NONE, rows, stop)?, links: filled(&[NONE; 2], pairs, stop)? })
    }

    /// Adds a pair that is in no list to the list of a row.
    pub(in crate::learners) fn add(&mut self, row: u32, pair: usize) {
        let after = self.first[row as usize];
        self.links[pair] = [after, NONE];
        if after != NONE {
            self.links[after as usize][1] = pair as u32;
        }
        self.first[row as usize] = pair as u32;
    }

    /// Removes a pair from the list of a row.
    pub(in crate::learners) fn remove(&mut self, row: u32, pair: usize) {
        let [after, before] = self.links[pair];
        if after != NONE {
            self.links[after as usize][1] = before;
        }
        if before == NONE {
            self.first[row as usize] = after;
        } else {
            self.links[before as usize][0] = after;
        }
    }

    /// The first pair of a row.
    #[inline]
    pub(in crate::learners) fn first(&self, row: u32) -> Option<usize> {
        Some(self.first[row as usize]).filter(|&pair| pair != NONE).map(|pair| pair as usize)
    }

    /// The pair after another one.
    #[inline]
    pub(in crate::learners) fn after(&self, pair: usize) -> Option<usize> {
        Some(self.links[pair][0]).filter(|&pair| pair != NONE).map(|pair| pair as usize)
    }

    /// Empties all lists.
    pub(in crate::learners) fn clear(&mut self) {
        self.first.fill(NONE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_beyond_32_bits_are_refused() {
        assert_eq!(Predecessors::new(2, 1 << 32, &StopFlag::new()), Err(AllocationError::TooManyEntries));
    }

    #[test]
    fn pairs_move_between_lists() {
        let mut lists = Predecessors::new(2, 4, &StopFlag::new()).expect("a few pairs");
        for pair in 0..4 {
            lists.add(0, pair);
        }
        for pair in [3, 1, 0] {
            lists.remove(0, pair);
            lists.add(1, pair);
        }
        let pairs = |row| std::iter::successors(lists.first(row), |&pair| lists.after(pair)).collect::<Vec<_>>();
        assert_eq!([pairs(0), pairs(1)], [vec![2], vec![0, 1, 3]]);
    }
}
