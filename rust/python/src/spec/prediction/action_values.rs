//! The action values of a greedy policy.

use std::sync::Arc;

use qtab_core::features::{ActiveFeatures, FeatureVector};
use qtab_core::numeric::{argmax_with_nan, sum_products};

/// The values of an observation, added over one or several tables.
pub(crate) struct ActionValues {
    tables: Arc<[f64]>,
    /// The number of rows of a table.
    n_rows: usize,
    values: Vec<f64>,
    /// The values of a single table.
    of_table: Vec<f64>,
    /// The weighted features of the last observation; none for binary features.
    pub(super) features: Box<FeatureVector>,
}

impl ActionValues {
    /// The values of tables with so many rows, all of which weighted features use. Returns `None` if there are too many of
    /// these.
    pub(super) fn new(tables: Arc<[f64]>, n_rows: usize, n_actions: usize, is_weighted: bool) -> Option<Self> {
        let features = Box::new(FeatureVector::zeros(if is_weighted { n_rows } else { 0 })?);
        let numbers = || vec![0.0; n_actions];
        Some(Self { tables, n_rows, values: numbers(), of_table: numbers(), features })
    }

    /// Adds up some rows of each table, from left to right.
    pub(super) fn add_rows(&mut self, active: &[u32]) {
        self.add_tables(|table, _, sums| {
            for (index, &row) in active.iter().enumerate() {
                let values = &table[row as usize * sums.len()..][..sums.len()];
                if index == 0 {
                    sums.copy_from_slice(values);
                } else {
                    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
                }
            }
        });
    }

    /// Adds up the products of the rows of each table and the features.
    pub(super) fn add_products(&mut self) {
        self.add_tables(|table, x, sums| {
            let n_actions = sums.len();
            for (action, sum) in sums.iter_mut().enumerate() {
                [*sum] = sum_products(x, |row| [table[row * n_actions + action]]);
            }
        });
    }

    /// Adds the values of the tables, each of which a function writes.
    fn add_tables(&mut self, write: impl Fn(&[f64], &[f64], &mut [f64])) {
        let Self { tables, n_rows, values, of_table, features } = self;
        for (index, table) in tables.chunks(*n_rows * values.len()).enumerate() {
            if index == 0 {
                write(table, features.values(), values);
            } else {
                write(table, features.values(), of_table);
                values.iter_mut().zip(&*of_table).for_each(|(value, part)| *value += part);
            }
        }
    }

    /// The action with the largest value, as by `np.argmax`, which takes the first NaN.
    pub(super) fn best(&self) -> usize {
        argmax_with_nan(&self.values)
    }

    /// The number of products for an observation.
    pub(super) fn products(&self) -> usize {
        if self.features.values().is_empty() { 0 } else { self.tables.len() }
    }
}
