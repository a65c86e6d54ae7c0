//! Linear function approximation with weighted features; see [`ActiveFeatures`] for the order of the operations. All rows
//! are active, in their order, so that no row is looked up.

use super::QTable;
use crate::features::ActiveFeatures;
use crate::numeric::{sum_products, sum_row_products};
use crate::schedules::StepSize;

impl<const N: usize> QTable<N> {
    /// The action values Σᵢ wᵢ xᵢ. Records an overflow: unlike a sum of weights, one of products can be NaN, and comparisons
    /// would pass over it.
    ///
    /// These functions are inlined into code for wide vector registers; WebAssembly has none, and a module that is downloaded
    /// should be small.
    #[cfg_attr(target_family = "wasm", inline(never))]
    #[cfg_attr(not(target_family = "wasm"), inline(always))]
    pub(super) fn weighted_action_values(&mut self, x: &[f64]) -> &[f64] {
        match self.num_actions() {
            2 => self.sum_products::<2>(x),
            3 => self.sum_products::<3>(x),
            4 => self.sum_products::<4>(x),
            num_actions => {
                for action in 0..num_actions {
                    self.sums[action] = self.weighted_value(x, action);
                }
            }
        }
        self.check_finite(self.sums.iter().fold(0.0, |sum, value| sum + value * 0.0));
        &self.sums
    }

    /// The sums for all of `A` actions at once, in registers.
    #[inline(always)]
    fn sum_products<const A: usize>(&mut self, x: &[f64]) {
        let weights = &self.values.as_chunks::<A>().0[..x.len()];
        let sums = sum_row_products(x, weights, |row| *row);
        self.sums.copy_from_slice(&sums);
    }

    /// The value Σᵢ wᵢ xᵢ of one action.
    #[cfg_attr(target_family = "wasm", inline(never))]
    #[cfg_attr(not(target_family = "wasm"), inline(always))]
    pub(super) fn weighted_value(&self, x: &[f64], action: usize) -> f64 {
        sum_column(&self.values, self.num_actions(), action, x)
    }

    /// wᵢ ← wᵢ + (αᵢ error) xᵢ.
    #[inline(always)]
    pub(super) fn update_weighted<R: ActiveFeatures + ?Sized>(
        &mut self,
        features: &R,
        action: usize,
        target: f64,
        step_size: &mut impl StepSize,
    ) {
        let error = target - self.value(features, action);
        self.check_finite(error);
        if step_size.log().is_some() {
            return self.update_logged(features, action, (target, error), step_size);
        }
        self.add_features(features.values(), action, error, step_size);
    }

    /// The update of a learner whose updates are logged.
    #[cold]
    fn update_logged<R: ActiveFeatures + ?Sized>(
        &mut self,
        features: &R,
        action: usize,
        (target, error): (f64, f64),
        step_size: &mut impl StepSize,
    ) {
        let old = self.value(features, action);
        self.add_features(features.values(), action, error, step_size);
        self.log(features, action, (old, target, None), step_size);
    }

    /// wᵢ ← wᵢ + (αᵢ scale) xᵢ.
    #[cfg_attr(target_family = "wasm", inline(never))]
    #[cfg_attr(not(target_family = "wasm"), inline(always))]
    pub(crate) fn add_features(&mut self, x: &[f64], action: usize, scale: f64, step_size: &impl StepSize) {
        let num_actions = self.num_actions();
        if let Some(steps) = step_size.of_rows() {
            let numbers = x.iter().zip(steps).map(|(x, step)| step * scale * x);
            add_to_column(&mut self.values, num_actions, action, numbers);
        } else {
            let change = step_size.at(0) * scale;
            add_to_column(&mut self.values, num_actions, action, x.iter().map(|x| change * x));
        }
    }
}

/// Σᵢ wᵢ xᵢ of a column of rows of `num_actions` weights.
#[inline(always)]
fn sum_column(weights: &[f64], num_actions: usize, action: usize, x: &[f64]) -> f64 {
    match num_actions {
        2 => sum_one_of::<2>(weights, action, x),
        3 => sum_one_of::<3>(weights, action, x),
        4 => sum_one_of::<4>(weights, action, x),
        _ => sum_products(x, |row| [weights[row * num_actions + action]])[0],
    }
}

/// Σᵢ wᵢ xᵢ of one of `A` columns.
#[inline(always)]
fn sum_one_of<const A: usize>(weights: &[f64], action: usize, x: &[f64]) -> f64 {
    assert!(action < A, "there are {A} actions");
    sum_row_products(x, &weights.as_chunks::<A>().0[..x.len()], |row| [row[action]])[0]
}

/// Adds a number to each weight of a column of rows of `num_actions` weights.
#[inline(always)]
pub(crate) fn add_to_column(
    weights: &mut [f64],
    num_actions: usize,
    action: usize,
    numbers: impl ExactSizeIterator<Item = f64>,
) {
    match num_actions {
        2 => add_to_one_of::<2>(weights, action, numbers),
        3 => add_to_one_of::<3>(weights, action, numbers),
        4 => add_to_one_of::<4>(weights, action, numbers),
        _ => weights[action..].iter_mut().step_by(num_actions).zip(numbers).for_each(|(weight, add)| *weight += add),
    }
}

/// Adds a number to each weight of one of `A` columns.
#[inline(always)]
fn add_to_one_of<const A: usize>(weights: &mut [f64], action: usize, numbers: impl ExactSizeIterator<Item = f64>) {
    assert!(action < A, "there are {A} actions");
    let rows = &mut weights.as_chunks_mut::<A>().0[..numbers.len()];
    rows.iter_mut().zip(numbers).for_each(|(row, add)| row[action] += add);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::FeatureVector;
    use crate::schedules::{LearningRate, Schedule};

    fn features() -> FeatureVector<3> {
        let Some(features) = FeatureVector::new(&[1.0, -0.5, 0.25]) else { unreachable!("there is room") };
        features
    }

    fn table(actions: usize) -> QTable {
        QTable::new((0..3 * actions).map(|index| 0.1 + 0.3 * index as f64).collect(), actions)
    }

    #[test]
    fn a_value_is_the_sum_of_the_products() {
        for actions in 1..=5 {
            let mut table = table(actions);
            let weights = table.values().to_vec();
            let expected: Vec<f64> = (0..actions)
                .map(|a| (weights[a] * 1.0 + weights[actions + a] * -0.5) + weights[2 * actions + a] * 0.25)
                .collect();
            assert_eq!(table.action_values(&features()), expected);
            assert_eq!((0..actions).map(|a| table.value(&features(), a)).collect::<Vec<_>>(), expected);
        }
    }

    #[test]
    fn four_partial_sums_are_added_in_pairs() {
        let x: Vec<f64> = (0..11).map(|index| 1.0 / f64::from(index + 3)).collect();
        let Some(features) = FeatureVector::<16>::new(&x) else { unreachable!("there is room") };
        let table = QTable::<0>::new(x.iter().map(|x| x.sin()).collect(), 1);
        let mut parts = [0.0; 4];
        for (index, (weight, x)) in table.values().iter().zip(&x).enumerate() {
            parts[index % 4] += weight * x;
        }
        assert_eq!(table.value(&features, 0), (parts[0] + parts[1]) + (parts[2] + parts[3]));
    }

    #[test]
    fn each_weight_moves_by_its_step_size_times_the_error_times_its_feature() {
        let mut scaled = LearningRate::scaled_by_row(Schedule::constant(0.3), vec![1.0, 1.0, 3.0]);
        let mut shared = LearningRate::scheduled(Schedule::constant(0.3), 1);
        for (rate, steps) in [(&mut scaled, [0.3, 0.3, 0.3 / 3.0]), (&mut shared, [0.3; 3])] {
            for logs in [false, true] {
                rate.set_logging(logs);
                let mut table = table(2);
                let before = table.values().to_vec();
                let error = 4.7 - table.value(&features(), 1);
                table.update(&features(), 1, 4.7, rate);
                let new = |row: usize, x: f64| before[2 * row + 1] + steps[row] * error * x;
                let expected = [before[0], new(0, 1.0), before[2], new(1, -0.5), before[4], new(2, 0.25)];
                assert_eq!(table.values(), expected);
            }
        }
        assert_eq!(scaled.logged().iter().count(), 1);
    }

    #[test]
    fn an_action_value_that_overflows_is_recorded_although_comparisons_pass_over_it() {
        for actions in 2..=5 {
            let mut weights = vec![0.0; 3 * actions];
            let mut table = QTable::<0>::new(weights.clone(), actions);
            table.action_values(&features());
            assert!(!table.diverged());
            // ∞ - ∞ in the last column; the other values are 0.
            (weights[actions - 1], weights[2 * actions - 1]) = (f64::MAX, f64::MAX);
            let Some(large) = FeatureVector::<3>::new(&[2.0, -2.0, 0.0]) else { unreachable!("there is room") };
            let mut table = QTable::<0>::new(weights, actions);
            assert!(table.action_values(&large)[actions - 1].is_nan());
            assert!(table.diverged());
        }
    }

    #[test]
    fn an_infinite_error_is_recorded() {
        let mut table = QTable::<0>::new(vec![f64::MAX; 3], 1);
        table.update(&features(), 0, -f64::MAX, &mut 0.5);
        assert!(table.diverged());
    }
}
