//! The greedy policy of a table: action values, and an episode.

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

/// The value of an action in the state with these active rows: the sum over the rows and the tables.
pub(crate) fn action_value(tables: &[&[f64]], rows: &[u32], num_actions: usize, action: usize) -> Option<f64> {
    let mut sum = 0.0;
    for table in tables {
        for &row in rows {
            sum += table.get(row as usize * num_actions + action)?;
        }
    }
    Some(sum)
}

/// The mean of the value over the tables, which unlike the sum has the scale of a return.
pub(crate) fn mean_action_value(tables: &[&[f64]], rows: &[u32], num_actions: usize, action: usize) -> Option<f64> {
    action_value(tables, rows, num_actions, action).map(|sum| sum / tables.len() as f64)
}

/// The first action with the largest value.
pub(crate) fn greedy_action(tables: &[&[f64]], rows: &[u32], num_actions: usize) -> Option<usize> {
    let mut best = (0, f64::NEG_INFINITY);
    for action in 0..num_actions {
        let value = action_value(tables, rows, num_actions, action)?;
        if value > best.1 {
            best = (action, value);
        }
    }
    Some(best.0)
}
