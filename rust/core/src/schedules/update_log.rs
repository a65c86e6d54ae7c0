//! A log of the updates of action values, with the numbers behind each.

/// An update of an action value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoggedUpdate {
    /// The action A.
    pub action: usize,
    /// Q(S, A) before the update.
    pub old: f64,
    /// Q(S, A) after the update.
    pub new: f64,
    /// The target.
    pub target: f64,
    /// The learning rate α, the sum of the step sizes of the active rows; `None` if the target replaced the value.
    pub learning_rate: Option<f64>,
}

/// Updates with the active rows of their states, oldest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UpdateLog {
    /// The rows of the first update, then those of the second one, and so on.
    rows: Vec<u32>,
    updates: Vec<LoggedUpdate>,
}

impl UpdateLog {
    /// Adds an update of the state with these active rows. Their number is the same for all states.
    pub fn push(&mut self, rows: &[u32], update: LoggedUpdate) {
        self.rows.extend_from_slice(rows);
        self.updates.push(update);
    }

    /// The updates, each with the active rows of its state.
    pub fn iter(&self) -> impl Iterator<Item = (&[u32], &LoggedUpdate)> {
        let n_active = (self.rows.len() / self.updates.len().max(1)).max(1);
        self.rows.chunks(n_active).zip(&self.updates)
    }

    /// Removes all updates and keeps the allocated memory.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.updates.clear();
    }
}
