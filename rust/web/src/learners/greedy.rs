//! The greedy policy of a table: action values, and an episode.

use qtab_core::features::ActiveFeatures;
use qtab_core::numeric::sum_products;

/// The steps of an episode.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Episode {
    /// The observations, one more than actions, with their components one after another.
    pub(crate) observations: Vec<f64>,
    pub(crate) actions: Vec<u8>,
    pub(crate) total_reward: f64,
    pub(crate) terminated: bool,
}

impl Episode {
    #[inline(never)]
    pub(crate) fn push(&mut self, observation: Vec<f64>, action: usize, reward: f64) {
        self.observations.extend(observation);
        self.actions.push(action as u8);
        self.total_reward += reward;
    }

    /// Adds the observation after the last step.
    pub(crate) fn end(&mut self, observation: Vec<f64>) {
        self.observations.extend(observation);
    }
}

/// The features of a state: its active rows, and with weighted features the number of each.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct StateFeatures {
    pub(crate) rows: Vec<u32>,
    /// Empty for binary features.
    values: Vec<f64>,
}

impl StateFeatures {
    #[inline(never)]
    pub(crate) fn of(features: &impl ActiveFeatures) -> Self {
        Self { rows: features.as_ref().to_vec(), values: features.values().to_vec() }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The numbers of weighted features, all of whose rows are active; `None` for binary features.
    pub(crate) fn weighted(&self) -> Option<&[f64]> {
        (!self.values.is_empty()).then_some(&self.values)
    }
}

/// The value of an action in a state: the sum of its values in the tables, which are added as in the core.
#[inline(never)]
pub(crate) fn action_value(
    tables: &[&[f64]],
    features: &StateFeatures,
    num_actions: usize,
    action: usize,
) -> Option<f64> {
    let mut sum = 0.0;
    for table in tables {
        sum += if let Some(x) = features.weighted() {
            let weights = table.get(..x.len() * num_actions)?;
            sum_products(x, |row| [weights[row * num_actions + action]])[0]
        } else {
            let mut value = 0.0;
            for &row in &features.rows {
                value += table.get(row as usize * num_actions + action)?;
            }
            value
        };
    }
    Some(sum)
}

/// The mean of the value over the tables, which unlike the sum has the scale of a return.
pub(crate) fn mean_action_value(
    tables: &[&[f64]],
    features: &StateFeatures,
    num_actions: usize,
    action: usize,
) -> Option<f64> {
    action_value(tables, features, num_actions, action).map(|sum| sum / tables.len() as f64)
}

/// The first action with the largest value.
#[inline(never)]
pub(crate) fn greedy_action(tables: &[&[f64]], features: &StateFeatures, num_actions: usize) -> Option<usize> {
    let mut best = (0, f64::NEG_INFINITY);
    for action in 0..num_actions {
        let value = action_value(tables, features, num_actions, action)?;
        if value > best.1 {
            best = (action, value);
        }
    }
    Some(best.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_values_of_two_tables_are_added_as_in_the_core() {
        let (first, second) = ([0.4, 0.3], [0.4, 0.6]);
        let value = action_value(&[&first, &second], &StateFeatures::of(&[0, 1]), 1, 0);
        // 1.7, whereas 0.4 + 0.3 + 0.4 + 0.6 from left to right is 1.7000000000000002.
        assert_eq!(value, Some((0.4 + 0.3) + (0.4 + 0.6)));
        let features = StateFeatures { rows: vec![0, 1], values: vec![1.5, -0.3] };
        assert_eq!(action_value(&[&first], &features, 1, 0), Some(0.4 * 1.5 + 0.3 * -0.3));
    }
}
