//! Linear function approximation with weighted features; see [`ActiveFeatures`] for the order of the operations. All rows
//! are active, in their order, so that no row is looked up.

use super::QTable;
use crate::features::ActiveFeatures;
use crate::numeric::sum_products;
use crate::schedules::StepSize;

impl<const N: usize> QTable<N> {
    /// The action values Σᵢ wᵢ xᵢ.
    #[inline]
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
        &self.sums
    }

    /// The sums for all of `A` actions at once, in registers.
    #[inline]
    fn sum_products<const A: usize>(&mut self, x: &[f64]) {
        let weights = &self.values.as_chunks::<A>().0[..x.len()];
        let sums = sum_products(x, |row| weights[row]);
        self.sums.copy_from_slice(&sums);
    }

    /// The value Σᵢ wᵢ xᵢ of one action.
    #[inline]
    pub(super) fn weighted_value(&self, x: &[f64], action: usize) -> f64 {
        match self.num_actions() {
            2 => self.sum_column::<2>(x, action),
            3 => self.sum_column::<3>(x, action),
            4 => self.sum_column::<4>(x, action),
            num_actions => sum_products(x, |row| [self.values[row * num_actions + action]])[0],
        }
    }

    /// The value of one of `A` actions.
    #[inline]
    fn sum_column<const A: usize>(&self, x: &[f64], action: usize) -> f64 {
        assert!(action < A, "there are {A} actions");
        let weights = &self.values.as_chunks::<A>().0[..x.len()];
        sum_products(x, |row| [weights[row][action]])[0]
    }

    /// wᵢ ← wᵢ + (αᵢ error) xᵢ.
    pub(super) fn update_weighted<R: ActiveFeatures + ?Sized>(
        &mut self,
        features: &R,
        action: usize,
        (target, error): (f64, f64),
        step_size: &mut impl StepSize,
    ) {
        self.check_finite(error);
        let old = step_size.log().is_some().then(|| self.value(features, action));
        let (x, num_actions) = (features.values(), self.num_actions());
        let weights = self.values[action..].iter_mut().step_by(num_actions).zip(x);
        if let Some(steps) = step_size.of_rows() {
            weights.zip(steps).for_each(|((weight, x), step)| *weight += step * error * x);
        } else {
            let change = step_size.at(0) * error;
            weights.for_each(|(weight, x)| *weight += change * x);
        }
        if let Some(old) = old {
            self.log(features, action, (old, target, None), step_size);
        }
    }
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
    fn an_infinite_error_is_recorded() {
        let mut table = QTable::<0>::new(vec![f64::MAX; 3], 1);
        table.update(&features(), 0, -f64::MAX, &mut 0.5);
        assert!(table.diverged());
    }
}
