//! Action values while a learner stores some of the values after the rows.

use super::{QTable, sum_rows};
use crate::features::ActiveFeatures;
use crate::numeric::sum;

impl QTable {
    /// The values of the rows, and those that a learner stores after them.
    #[inline(always)]
    pub(crate) fn storage_mut(&mut self) -> &mut Vec<f64> {
        &mut self.values
    }

    /// [`action_values`](Self::action_values), where `slots` holds the index in the storage of each weight's value.
    #[inline(always)]
    pub(crate) fn values_at<R: ActiveFeatures>(&mut self, slots: &[u32], rows: &R) -> &[f64] {
        match self.num_actions() {
            2 => self.sum_slots::<2>(slots, rows.as_ref()),
            3 => self.sum_slots::<3>(slots, rows.as_ref()),
            4 => self.sum_slots::<4>(slots, rows.as_ref()),
            num_actions => {
                for action in 0..num_actions {
                    self.sums[action] = self.value_at(slots, rows.as_ref(), action);
                }
            }
        }
        &self.sums
    }

    /// [`value`](Self::value) with the same slots.
    #[inline(always)]
    pub(crate) fn value_at(&self, slots: &[u32], rows: &[u32], action: usize) -> f64 {
        sum(rows.iter().map(|&row| self.values[slots[self.weight_index(row, action)] as usize]))
    }

    /// Sums rows of `A` values for all actions at once, in registers.
    #[inline(always)]
    fn sum_slots<const A: usize>(&mut self, slots: &[u32], rows: &[u32]) {
        let slots = slots.as_chunks::<A>().0;
        let sums = sum_rows(rows.iter().map(|&row| slots[row as usize].map(|slot| self.values[slot as usize])));
        self.sums.copy_from_slice(&sums);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const A: usize>(rows: &[u32]) {
        let values = (0..4 * A).map(|weight| 0.1 * weight as f64).collect::<Vec<_>>();
        let (mut table, mut moved) = (QTable::<0>::new(values.clone(), A), QTable::<0>::new(values.clone(), A));
        // Every other value is stored after the rows, in reverse order, and its old place holds garbage.
        let mut slots: Vec<u32> = (0..).take(4 * A).collect();
        for weight in (0..4 * A).step_by(2) {
            slots[weight] = moved.values.len() as u32;
            moved.values.push(values[weight]);
            moved.values[weight] = f64::NAN;
        }
        let one_by_one: Vec<f64> = (0..A).map(|action| moved.value_at(&slots, rows, action)).collect();
        assert_eq!(moved.values_at(&slots, &rows), table.action_values(rows));
        assert_eq!(one_by_one, table.action_values(rows));
    }

    #[test]
    fn values_are_found_where_they_have_moved() {
        for rows in [&[2][..], &[0, 3, 1], &[1, 1]] {
            check::<1>(rows);
            check::<2>(rows);
            check::<3>(rows);
            check::<4>(rows);
            check::<5>(rows);
        }
    }
}
