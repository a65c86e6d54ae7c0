//! The greedy policy of learned tables.

use crate::features::ActiveFeatures;
use crate::numeric::{argmax_with_nan, sum_products};

/// The greedy policy: the action that `np.argmax` finds, the first one with the largest value, or with the value NaN if there
/// is one. It is a copy of the learned values, so training can continue beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct GreedyPolicy {
    /// The tables whose action values are added.
    tables: Vec<Vec<f64>>,
    num_actions: usize,
}

impl GreedyPolicy {
    /// The policy that maximizes the sum of the action values of some tables, given row by row, over the available actions.
    /// `masks` holds whether each action is available in each row; masks of another size, as learners have with several
    /// active rows, are ignored.
    ///
    /// # Panics
    /// If there is no table, if the tables differ in size, or if they have no rows of `num_actions` values.
    pub fn new(tables: &[&[f64]], num_actions: usize, masks: Option<&[bool]>) -> Self {
        let [first, others @ ..] = tables else { panic_without_tables() };
        assert!(num_actions > 0 && first.len().is_multiple_of(num_actions), "a row must have {num_actions} values");
        assert!(others.iter().all(|table| table.len() == first.len()), "the tables must have the same size");
        let mut tables: Vec<_> = tables.iter().map(|table| table.to_vec()).collect();
        if let Some(masks) = masks.filter(|masks| masks.len() == first.len()) {
            for table in &mut tables {
                mask(table, masks);
            }
        }
        Self { tables, num_actions }
    }

    /// The number of rows and of actions.
    pub fn shape(&self) -> (usize, usize) {
        (self.tables[0].len() / self.num_actions, self.num_actions)
    }

    /// The greedy action of the state with these active rows, which
    /// [`Features::active_rows`](crate::Features::active_rows) returns.
    ///
    /// # Panics
    /// If a row is not in the table.
    pub fn action(&self, rows: impl ActiveFeatures) -> usize {
        argmax_with_nan(&self.action_values(rows))
    }

    /// The greedy action among the available ones, given whether each action is available.
    ///
    /// # Panics
    /// As for `action`.
    pub fn action_among(&self, rows: impl ActiveFeatures, available: &[bool]) -> usize {
        let mut values = self.action_values(rows);
        mask(&mut values, available);
        argmax_with_nan(&values)
    }

    /// The action values of the state with these active rows, each the sum over the rows; with weighted features, each
    /// row is multiplied by its value. Those of several tables are added, as a learner with two tables adds them.
    ///
    /// # Panics
    /// As for `action`.
    pub fn action_values<R: ActiveFeatures>(&self, rows: R) -> Vec<f64> {
        let mut tables = self.tables.iter().map(|table| self.values_in(table, &rows));
        let mut sums = tables.next().unwrap_or_default();
        for values in tables {
            add(&mut sums, &values);
        }
        sums
    }

    /// The action values of a table.
    fn values_in<R: ActiveFeatures>(&self, table: &[f64], rows: &R) -> Vec<f64> {
        if R::WEIGHTED {
            let weight = |row: usize, action: usize| table[row * self.num_actions + action];
            let value = |action| sum_products(rows.values(), |row| [weight(row, action)])[0];
            return (0..self.num_actions).map(value).collect();
        }
        let mut rows = rows.as_ref().iter().map(|&row| &table[row as usize * self.num_actions..][..self.num_actions]);
        // A sum that begins with a value keeps the sign of its zero.
        let mut sums = rows.next().map_or_else(|| vec![0.0; self.num_actions], <[f64]>::to_vec);
        for row in rows {
            add(&mut sums, row);
        }
        sums
    }
}

/// Adds numbers to sums.
fn add(sums: &mut [f64], numbers: &[f64]) {
    sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
}

/// Replaces the values of unavailable actions by -∞.
fn mask(values: &mut [f64], available: &[bool]) {
    for (value, _) in values.iter_mut().zip(available).filter(|(_, available)| !**available) {
        *value = f64::NEG_INFINITY;
    }
}

#[expect(clippy::panic, reason = "documented")]
fn panic_without_tables() -> ! {
    panic!("a greedy policy needs a table")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::FeatureVector;

    #[test]
    fn the_first_of_the_largest_sums_is_greedy() {
        let policy = GreedyPolicy::new(&[&[1.0, 2.0, 0.0, 0.0], &[1.0, 0.0, 0.5, 1.0]], 2, None);
        assert_eq!(policy.shape(), (2, 2));
        assert_eq!([policy.action([0]), policy.action([1]), policy.action([0, 1])], [0, 1, 1]);
        assert_eq!(policy.action_values([0, 1]), [2.5, 3.0]);
    }

    #[test]
    fn the_values_of_several_tables_are_added_after_those_of_the_rows() {
        let policy = GreedyPolicy::new(&[&[0.1, 0.2], &[0.3, 0.7]], 1, None);
        // 1.3, whereas (0.1 + 0.3) + (0.2 + 0.7) is 1.2999999999999998.
        assert_eq!(policy.action_values([0, 1]), [(0.1 + 0.2) + (0.3 + 0.7)]);
        let features = FeatureVector::<2>::new(&[1.5, -0.3]).expect("there is room");
        let expected = (0.1 * 1.5 + 0.2 * -0.3) + (0.3 * 1.5 + 0.7 * -0.3);
        assert_eq!(policy.action_values(features), [expected]);
    }

    #[test]
    fn the_first_action_whose_value_is_not_a_number_is_greedy() {
        // ∞ - ∞ in the second column.
        let policy = GreedyPolicy::new(&[&[1.0, f64::MAX, 1.0, f64::MAX]], 2, None);
        let features = FeatureVector::<2>::new(&[2.0, -2.0]).expect("there is room");
        assert!(policy.action_values(features)[1].is_nan());
        assert_eq!(policy.action(features), 1);
        assert_eq!(policy.action_among(features, &[true, true]), 1);
        assert_eq!(policy.action_among(features, &[true, false]), 0);
    }

    #[test]
    fn an_unavailable_action_is_not_greedy() {
        let policy = GreedyPolicy::new(&[&[1.0, 2.0]], 2, Some(&[true, false]));
        assert_eq!(policy.action([0]), 0);
        let policy = GreedyPolicy::new(&[&[1.0, 2.0]], 2, None);
        assert_eq!(policy.action_among([0], &[true, false]), 0);
    }
}
