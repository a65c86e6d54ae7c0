//! The Q table: rows of action values in one block, C order.

mod linear;

use crate::random::Draw;

/// Action values, `N` a row; `N` = 0 leaves their count to run time. Where it is known, the searches are unrolled.
#[derive(Clone, Debug, PartialEq)]
pub struct Table<const N: usize = 0> {
    values: Vec<f64>,
    actions: usize,
    /// Where the values of an observation that lights several rows are added up.
    sums: Vec<f64>,
    /// Zero while all is well; NaN from the first update on that was infinite.
    alarm: f64,
}

impl<const N: usize> Table<N> {
    /// A table to go on from, in C order.
    ///
    /// # Panics
    /// If `actions` is not `N` (where `N` is not 0), is 0, or does not divide the number of values.
    pub fn new(values: Vec<f64>, actions: usize) -> Self {
        assert!(N == 0 || N == actions, "a table of {N} actions a row was given {actions}");
        assert!(values.len().is_multiple_of(actions), "{} values are no rows of {actions}", values.len());
        Self { values, actions, sums: vec![0.0; actions], alarm: 0.0 }
    }

    /// `rng.uniform(low, high, (rows, actions))`.
    pub fn uniform(rows: usize, actions: usize, low: f64, high: f64, draw: &mut impl Draw) -> Self {
        Self::new((0..rows * actions).map(|_| draw.uniform(low, high)).collect(), actions)
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
    pub fn actions(&self) -> usize {
        if N == 0 { self.actions } else { N }
    }

    /// The action values of a row.
    #[inline]
    pub fn row(&self, row: u32) -> &[f64] {
        if N > 0 {
            return &self.values.as_chunks::<N>().0[row as usize];
        }
        let actions = self.actions();
        &self.values[row as usize * actions..][..actions]
    }

    /// One action value.
    #[inline]
    pub fn value_mut(&mut self, row: u32, action: usize) -> &mut f64 {
        if N > 0 {
            return &mut self.values.as_chunks_mut::<N>().0[row as usize][action];
        }
        let actions = self.actions();
        &mut self.values[row as usize * actions..][..actions][action]
    }
}

/// The first of the largest values: `np.argmax`.
#[inline]
pub(crate) fn first_maximum(values: &[f64]) -> usize {
    // The largest value is carried along: looked up by index, it would add a load to the chain of comparisons.
    let larger = |one: (usize, f64), other: (usize, f64)| if other.1 > one.1 { other } else { one };
    let mut best = (0, values[0]);
    if values.len() < 4 {
        for (action, &value) in values.iter().enumerate().skip(1) {
            best = larger(best, (action, value));
        }
        return best.0;
    }
    // By pairs, so that fewer comparisons wait for each other.
    for (pair, values) in values.chunks(2).enumerate() {
        let first = (2 * pair, values[0]);
        let of_pair = if let &[_, second] = values { larger(first, (2 * pair + 1, second)) } else { first };
        best = if pair == 0 { of_pair } else { larger(best, of_pair) };
    }
    best.0
}

/// `np.max`.
#[inline]
pub(crate) fn maximum(values: &[f64]) -> f64 {
    values[1..].iter().fold(values[0], |largest, &value| if value > largest { value } else { largest })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_equal_maxima_wins() {
        assert_eq!(first_maximum(&[1.0, 3.0, 3.0]), 1);
        assert_eq!(first_maximum(&[0.0, -0.0]), 0);
        assert_eq!(maximum(&[-2.0, -1.0, -3.0]), -1.0);
    }

    #[test]
    #[should_panic(expected = "no rows of 3")]
    fn a_ragged_table_is_refused() {
        Table::<3>::new(vec![0.0; 4], 3);
    }
}
