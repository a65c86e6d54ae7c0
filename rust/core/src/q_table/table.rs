//! The Q table: rows of action values in one block, C order.

use crate::random::Rng;

/// Action values, `N` a row; `N` = 0 leaves their count to run time. Where it is known, the searches are unrolled.
#[derive(Clone, Debug, PartialEq)]
pub struct QTable<const N: usize = 0> {
    pub(super) values: Vec<f64>,
    actions: usize,
    /// Where the values of an observation that lights several rows are added up.
    pub(super) sums: Vec<f64>,
    /// Zero while all is well; NaN from the first update on that was infinite.
    pub(super) divergence: f64,
}

impl<const N: usize> QTable<N> {
    /// A table to go on from, in C order.
    ///
    /// # Panics
    /// If `actions` is not `N` (where `N` is not 0), is 0, or does not divide the number of values.
    pub fn new(values: Vec<f64>, actions: usize) -> Self {
        assert!(N == 0 || N == actions, "a table of {N} actions a row was given {actions}");
        assert!(values.len().is_multiple_of(actions), "{} values are no rows of {actions}", values.len());
        Self { values, actions, sums: vec![0.0; actions], divergence: 0.0 }
    }

    /// `rng.uniform(low, high, (rows, actions))`.
    pub fn uniform(rows: usize, actions: usize, low: f64, high: f64, rng: &mut impl Rng) -> Self {
        Self::new((0..rows * actions).map(|_| rng.uniform(low, high)).collect(), actions)
    }

    /// All values, rows first.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    pub(crate) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// How many values a row has.
    #[inline]
    pub fn num_actions(&self) -> usize {
        if N == 0 { self.actions } else { N }
    }

    /// The action values of a row.
    #[inline]
    pub fn row(&self, row: u32) -> &[f64] {
        if N > 0 {
            return &self.values.as_chunks::<N>().0[row as usize];
        }
        let actions = self.num_actions();
        &self.values[row as usize * actions..][..actions]
    }

    /// One action value.
    #[inline]
    pub fn value_mut(&mut self, row: u32, action: usize) -> &mut f64 {
        if N > 0 {
            return &mut self.values.as_chunks_mut::<N>().0[row as usize][action];
        }
        let actions = self.num_actions();
        &mut self.values[row as usize * actions..][..actions][action]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "no rows of 3")]
    fn a_ragged_table_is_refused() {
        QTable::<3>::new(vec![0.0; 4], 3);
    }
}
