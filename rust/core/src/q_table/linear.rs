//! Linear function approximation: with binary features an action value is the sum over the active rows, from left to
//! right (Sutton & Barto, equation 9.8). With one active row, as on a grid, it is the value of that row. With weighted
//! features each row is multiplied by the value of its feature.

use super::QTable;
use crate::features::ActiveFeatures;
use crate::numeric::sum;
use crate::schedules::{LoggedUpdate, StepSize};

/// The update at a terminal state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerminalUpdate {
    /// Q ← R, the article's rule. It is right only if the last reward is always the same.
    Assign,
    /// Q ← Q + α (R - Q): the value of a terminal state is zero (Sutton & Barto, section 6.1).
    Target,
}

impl<const N: usize> QTable<N> {
    /// The action values of an observation with these active rows.
    #[inline(always)]
    pub fn action_values<R: ActiveFeatures + ?Sized>(&mut self, rows: &R) -> &[f64] {
        if R::WEIGHTED { self.weighted_action_values(rows.values()) } else { self.binary_action_values(rows) }
    }

    #[inline]
    fn binary_action_values<R: ActiveFeatures + ?Sized>(&mut self, rows: &R) -> &[f64] {
        let rows = rows.as_ref();
        if let &[row] = rows {
            return self.row(row);
        }
        match self.num_actions() {
            2 => self.sum_rows::<2>(rows),
            3 => self.sum_rows::<3>(rows),
            4 => self.sum_rows::<4>(rows),
            num_actions => {
                for action in 0..num_actions {
                    self.sums[action] = self.value(rows, action);
                }
            }
        }
        &self.sums
    }

    /// Sums rows of `A` values for all actions at once, in registers.
    #[inline]
    fn sum_rows<const A: usize>(&mut self, rows: &[u32]) {
        let table = self.values.as_chunks::<A>().0;
        let sums = sum_rows(rows.iter().map(|&row| table[row as usize]));
        self.sums.copy_from_slice(&sums);
    }

    /// The value of one action with these active rows.
    #[inline(always)]
    pub fn value<R: ActiveFeatures + ?Sized>(&self, rows: &R, action: usize) -> f64 {
        if R::WEIGHTED { self.weighted_value(rows.values(), action) } else { self.binary_value(rows, action) }
    }

    #[inline]
    fn binary_value<R: ActiveFeatures + ?Sized>(&self, rows: &R, action: usize) -> f64 {
        // The bounds check of the action is then that of `value_mut`.
        if N > 0
            && let &[row] = rows.as_ref()
        {
            return self.row(row)[action];
        }
        sum(rows.as_ref().iter().map(|&row| self.values[self.weight_index(row, action)]))
    }

    /// The index of the weight of an action in a row, as used for step sizes and traces.
    #[inline]
    pub fn weight_index(&self, row: u32, action: usize) -> usize {
        row as usize * self.num_actions() + action
    }

    /// Q ← Q + α (target - Q). Each active row moves by its step size times the error, and with weighted features times
    /// the value of its feature.
    #[inline(always)]
    pub fn update<R: ActiveFeatures + ?Sized>(
        &mut self,
        rows: &R,
        action: usize,
        target: f64,
        step_size: &mut impl StepSize,
    ) {
        if R::WEIGHTED {
            self.update_weighted(rows, action, target, step_size);
        } else {
            self.update_binary(rows, action, target, step_size);
        }
    }

    #[inline]
    fn update_binary<R: ActiveFeatures + ?Sized>(
        &mut self,
        rows: &R,
        action: usize,
        target: f64,
        step_size: &mut impl StepSize,
    ) {
        // The only row is looked up once. Without a known number of actions this would take more instructions.
        if N > 0
            && let (&[row], Some(step)) = (rows.as_ref(), step_size.uniform())
        {
            let value = self.value_mut(row, action);
            *value += step * (target - *value);
            return;
        }
        let error = target - self.value(rows, action);
        let rows = rows.as_ref();
        if rows.len() != 1 {
            self.check_finite(error);
        }
        match step_size.uniform() {
            Some(step) => rows.iter().for_each(|&row| *self.value_mut(row, action) += step * error),
            None => self.update_each(rows, action, (target, error), step_size),
        }
    }

    /// The update with a step size for each weight, or with logging. It is a separate function because inlining it
    /// costs the learners with a uniform step size up to 6 % more instructions per step.
    #[inline(never)]
    fn update_each(&mut self, rows: &[u32], action: usize, (target, error): (f64, f64), step_size: &mut impl StepSize) {
        let old = step_size.log().is_some().then(|| self.value(rows, action));
        let mut learning_rate = 0.0;
        for &row in rows {
            let weight_index = self.weight_index(row, action);
            step_size.visit(weight_index);
            let step = step_size.at(weight_index);
            *self.value_mut(row, action) += step * error;
            learning_rate += step;
        }
        if let Some(old) = old {
            self.log(rows, action, (old, target, Some(learning_rate)), step_size);
        }
    }

    #[cold]
    pub(super) fn log<R: ActiveFeatures + ?Sized>(
        &self,
        rows: &R,
        action: usize,
        (old, target, learning_rate): (f64, f64, Option<f64>),
        step_size: &mut impl StepSize,
    ) {
        if let Some(log) = step_size.log() {
            let new = self.value(rows, action);
            log.push(rows.as_ref(), LoggedUpdate { action, old, new, target, learning_rate });
        }
    }

    /// The update of the last state-action pair of an episode.
    ///
    /// # Panics
    /// With [`TerminalUpdate::Assign`] and several active rows, or weighted features.
    #[inline]
    pub fn update_terminal<R: ActiveFeatures + ?Sized>(
        &mut self,
        rows: &R,
        action: usize,
        reward: f64,
        update: TerminalUpdate,
        step_size: &mut impl StepSize,
    ) {
        match update {
            TerminalUpdate::Target if R::WEIGHTED => self.update(rows, action, reward, step_size),
            // The rows as a slice: a second call of the update for this type would keep it from being inlined.
            TerminalUpdate::Target => self.update(rows.as_ref(), action, reward, step_size),
            TerminalUpdate::Assign => {
                let active = rows.as_ref();
                assert!(active.len() == 1 && !R::WEIGHTED, "TerminalUpdate::Assign needs exactly one active row");
                let old = std::mem::replace(self.value_mut(active[0], action), reward);
                if step_size.log().is_some() {
                    self.log(rows, action, (old, reward, None), step_size);
                }
            }
        }
    }

    /// Records an error that is infinite or NaN. With one active row this check is unnecessary: with a step size of at
    /// most 1, a value never leaves the range of its targets.
    #[inline]
    pub fn check_finite(&mut self, error: f64) {
        // 0 for a finite error, NaN otherwise.
        self.divergence += error * 0.0;
    }

    /// Whether a recorded error was infinite or NaN.
    #[inline]
    pub fn diverged(&self) -> bool {
        // Integers compare faster than floats. The divergence is never -0.
        self.divergence.to_bits() != 0
    }
}

/// The sums of the values of all actions, in registers.
#[inline(always)]
pub(crate) fn sum_rows<const A: usize>(mut rows: impl Iterator<Item = [f64; A]>) -> [f64; A] {
    let mut sums = rows.next().unwrap_or([0.0; A]);
    for values in rows {
        for (sum, value) in sums.iter_mut().zip(values) {
            *sum += value;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StopFlag;
    use crate::schedules::{LearningRate, Schedule};

    #[test]
    fn a_value_is_the_sum_over_the_active_rows() {
        let mut table = QTable::<2>::new(vec![1.0, 2.0, 10.0, 20.0, 100.0, 200.0], 2);
        assert_eq!(table.action_values(&[0, 2]), [101.0, 202.0]);
        assert_eq!(table.action_values(&[1]), [10.0, 20.0]);
        assert_eq!(table.value(&[0, 1, 2], 1), 222.0);
    }

    #[test]
    fn a_row_that_is_active_twice_counts_twice() {
        let mut table = QTable::<1>::new(vec![3.0], 1);
        assert_eq!(table.action_values(&[0, 0]), [6.0]);
        table.update(&[0, 0], 0, 7.0, &mut 0.5);
        assert_eq!(table.values(), [4.0]);
    }

    #[test]
    fn logging_changes_no_update() {
        let by_visit_count = LearningRate::by_visit_count(1.0, 0.0, 3, 2, &StopFlag::new()).expect("three weights");
        for learning_rate in [LearningRate::scheduled(Schedule::constant(0.3), 2), by_visit_count] {
            let mut table = QTable::<1>::new(vec![0.1, 0.7, -3.0], 1);
            let mut expected = table.clone();
            let (mut logged, mut rate) = (learning_rate.clone(), learning_rate);
            logged.set_logging(true);
            let mut updates = Vec::new();
            for (rows, target) in [([0, 1], 5.0), ([1, 2], -0.3), ([0, 1], 1.9)] {
                expected.update(&rows, 0, target, &mut rate);
                table.update(&rows, 0, target, &mut logged);
                updates.push((rows.to_vec(), target));
            }
            assert_eq!(table.values(), expected.values());
            let found: Vec<_> = logged.logged().iter().map(|(rows, update)| (rows.to_vec(), update.target)).collect();
            assert_eq!(found, updates);
        }
    }

    #[test]
    fn a_logged_update_is_its_equation() {
        let mut rate = LearningRate::by_visit_count(1.0, 0.0, 2, 1, &StopFlag::new()).expect("two weights");
        rate.set_logging(true);
        let mut table = QTable::<2>::new(vec![0.5, 2.0], 2);
        table.update(&[0], 1, 4.0, &mut rate);
        table.update(&[0], 1, 7.0, &mut rate);
        table.update_terminal(&[0], 0, -3.0, TerminalUpdate::Assign, &mut rate);
        let updates: Vec<_> = rate.logged().iter().map(|(_, update)| *update).collect();
        let update = |action, old, new, target, learning_rate| LoggedUpdate { action, old, new, target, learning_rate };
        let expected = [
            update(1, 2.0, 4.0, 4.0, Some(1.0)),
            update(1, 4.0, 5.5, 7.0, Some(0.5)),
            update(0, 0.5, -3.0, -3.0, None),
        ];
        assert_eq!(updates, expected);
        rate.logged().clear();
        assert_eq!(rate.logged().iter().count(), 0);
    }

    #[test]
    fn an_overflow_is_recorded() {
        let mut table = QTable::<1>::new(vec![1e308, 1e308], 1);
        table.update(&[0, 1], 0, 0.0, &mut 0.5);
        assert!(table.diverged());
    }
}
