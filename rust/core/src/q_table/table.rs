//! The storage of a Q table.

use crate::random::Rng;

/// A Q table: rows of `N` action values in C order. With `N = 0` the number of actions is known only at run time;
/// otherwise the compiler unrolls the loops over a row.
#[derive(Clone, Debug, PartialEq)]
pub struct QTable<const N: usize = 0> {
    /// The rows. A learner may store some of their values after them while it learns.
    pub(super) values: Vec<f64>,
    /// The number of values in the rows.
    len: usize,
    num_actions: usize,
    /// A buffer for the sums over several active rows.
    pub(super) sums: Vec<f64>,
    /// 0, or NaN after an error that was infinite or NaN.
    pub(super) divergence: f64,
}

/// Tables whose number of actions is a value, not a type: what [`AnyLearner`](crate::learners::AnyLearner) takes.
impl QTable {
    /// A table of zeros.
    pub fn zeros(rows: usize, num_actions: usize) -> Self {
        Self::filled(rows, num_actions, 0.0)
    }

    /// A table that holds the same value everywhere.
    pub fn filled(rows: usize, num_actions: usize, value: f64) -> Self {
        Self::new(vec![value; rows * num_actions], num_actions)
    }

    /// A table with these values, row by row; `None` if they do not fill rows of `num_actions` values.
    pub fn from_values(values: Vec<f64>, num_actions: usize) -> Option<Self> {
        (num_actions > 0 && values.len().is_multiple_of(num_actions)).then(|| Self::new(values, num_actions))
    }
}

impl<const N: usize> QTable<N> {
    /// A table with these values, in C order. Where the compiler cannot infer `N`, write `QTable::<0>::new`, or use
    /// [`zeros`](QTable::zeros) or [`from_values`](QTable::from_values).
    ///
    /// # Panics
    /// If `num_actions` is 0, differs from a non-zero `N`, or does not divide the number of values.
    pub fn new(values: Vec<f64>, num_actions: usize) -> Self {
        assert!(N == 0 || N == num_actions, "num_actions must be {N}, got {num_actions}");
        let len = values.len();
        assert!(len.is_multiple_of(num_actions), "the table must have rows of {num_actions} values, got {len} values");
        Self { values, len, num_actions, sums: vec![0.0; num_actions], divergence: 0.0 }
    }

    /// A table of random values: `rng.uniform(low, high, (rows, num_actions))`.
    ///
    /// # Panics
    /// As for `new`.
    pub fn uniform(rows: usize, num_actions: usize, low: f64, high: f64, rng: &mut impl Rng) -> Self {
        Self::new((0..rows * num_actions).map(|_| rng.uniform(low, high)).collect(), num_actions)
    }

    /// All values, row by row.
    pub fn values(&self) -> &[f64] {
        &self.values[..self.len]
    }

    pub(crate) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values[..self.len]
    }

    /// Exchanges the storage of the values, including those that a learner stores after the rows. The table must not be
    /// used until its storage has been swapped back.
    pub(crate) fn swap_storage(&mut self, storage: &mut Vec<f64>) {
        std::mem::swap(&mut self.values, storage);
    }

    /// The number of values per row.
    #[inline]
    pub fn num_actions(&self) -> usize {
        if N == 0 { self.num_actions } else { N }
    }

    /// The number of rows and of actions.
    pub fn shape(&self) -> (usize, usize) {
        (self.len / self.num_actions, self.num_actions)
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

    /// The action values of a row, mutable.
    #[inline]
    pub(crate) fn row_mut(&mut self, row: u32) -> &mut [f64] {
        let actions = self.num_actions();
        &mut self.values[row as usize * actions..][..actions]
    }

    /// The value of an action in a row, mutable.
    #[inline]
    pub fn value_mut(&mut self, row: u32, action: usize) -> &mut f64 {
        if N > 0 {
            return &mut self.values.as_chunks_mut::<N>().0[row as usize][action];
        }
        let weight_index = self.weight_index(row, action);
        &mut self.values[weight_index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_needs_no_type_arguments() {
        assert_eq!(QTable::zeros(2, 3).shape(), (2, 3));
        assert_eq!(QTable::filled(1, 2, 0.5).values(), [0.5, 0.5]);
        assert_eq!(QTable::from_values(vec![1.0, 2.0], 2).map(|table| table.row(0).to_vec()), Some(vec![1.0, 2.0]));
        assert_eq!(QTable::from_values(vec![1.0], 2), None);
        assert_eq!(QTable::from_values(vec![1.0], 0), None);
    }

    #[test]
    #[should_panic(expected = "rows of 3 values")]
    fn a_ragged_table_is_refused() {
        QTable::<3>::new(vec![0.0; 4], 3);
    }
}
