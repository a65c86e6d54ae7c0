//! Values of observations that light several rows: a value is the sum over its rows, from the first (Sutton & Barto,
//! equation 9.8 with binary features). A grid lights one row, and its value is that row's.

use super::{QTable, TerminalUpdate};
use crate::schedules::StepSize;

impl<const N: usize> QTable<N> {
    /// The action values of these rows.
    #[inline]
    pub fn action_values(&mut self, rows: &[u32]) -> &[f64] {
        if let &[row] = rows {
            return self.row(row);
        }
        match self.num_actions() {
            2 => self.add_up::<2>(rows),
            3 => self.add_up::<3>(rows),
            4 => self.add_up::<4>(rows),
            actions => {
                for action in 0..actions {
                    self.sums[action] = self.value(rows, action);
                }
            }
        }
        &self.sums
    }

    /// The sums of `A` actions side by side, in registers.
    #[inline]
    fn add_up<const A: usize>(&mut self, rows: &[u32]) {
        let mut values = rows.iter().filter_map(|&row| self.values[row as usize * A..].first_chunk::<A>());
        let mut sums = values.next().copied().unwrap_or([0.0; A]);
        for values in values {
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value;
            }
        }
        self.sums.copy_from_slice(&sums);
    }

    /// One action value of these rows.
    #[inline]
    pub fn value(&self, rows: &[u32], action: usize) -> f64 {
        let mut values = rows.iter().map(|&row| self.row(row)[action]);
        let first = values.next().unwrap_or(0.0);
        values.fold(first, |sum, value| sum + value)
    }

    /// The weight of an action in a row, as step sizes and traces count them.
    #[inline]
    pub fn weight_index(&self, row: u32, action: usize) -> usize {
        row as usize * self.num_actions() + action
    }

    /// The value of a weight.
    #[inline]
    pub fn weight_mut(&mut self, weight_index: usize) -> &mut f64 {
        &mut self.values[weight_index]
    }

    /// Q ← Q + α (target - Q), evaluated from the left; the rows share it.
    #[inline]
    pub fn update(&mut self, rows: &[u32], action: usize, target: f64, step_size: &mut impl StepSize) {
        let error = target - self.value(rows, action);
        if rows.len() != 1 {
            self.check_finite(error);
        }
        for &row in rows {
            let weight_index = self.weight_index(row, action);
            step_size.visit(weight_index);
            let step = step_size.at(weight_index);
            *self.value_mut(row, action) += step * error;
        }
    }

    /// The update at a terminal state.
    ///
    /// # Panics
    /// If several rows are to be assigned to.
    #[inline]
    pub fn update_terminal(
        &mut self,
        rows: &[u32],
        action: usize,
        reward: f64,
        update: TerminalUpdate,
        step_size: &mut impl StepSize,
    ) {
        match update {
            TerminalUpdate::Target => self.update(rows, action, reward, step_size),
            TerminalUpdate::Assign => {
                assert!(rows.len() == 1, "only a lone row can be assigned to");
                *self.value_mut(rows[0], action) = reward;
            }
        }
    }

    /// Remembers an error that is infinite or NaN. A lone row needs no watch: its value stays between its targets.
    #[inline]
    pub fn check_finite(&mut self, error: f64) {
        self.divergence += error * 0.0;
    }

    /// Whether an error was infinite or NaN.
    #[inline]
    pub fn diverged(&self) -> bool {
        self.divergence != 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_the_sum_over_its_rows() {
        let mut table = QTable::<2>::new(vec![1.0, 2.0, 10.0, 20.0, 100.0, 200.0], 2);
        assert_eq!(table.action_values(&[0, 2]), [101.0, 202.0]);
        assert_eq!(table.action_values(&[1]), [10.0, 20.0]);
        assert_eq!(table.value(&[0, 1, 2], 1), 222.0);
    }

    #[test]
    fn a_row_that_is_lit_twice_counts_twice() {
        let mut table = QTable::<1>::new(vec![3.0], 1);
        assert_eq!(table.action_values(&[0, 0]), [6.0]);
        table.update(&[0, 0], 0, 7.0, &mut 0.5);
        assert_eq!(table.values(), [4.0]);
    }

    #[test]
    fn an_overflow_is_remembered() {
        let mut table = QTable::<1>::new(vec![1e308, 1e308], 1);
        table.update(&[0, 1], 0, 0.0, &mut 0.5);
        assert!(table.diverged());
    }
}
