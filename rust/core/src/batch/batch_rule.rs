//! The update rules that batches know.

use crate::learners::{QLearning, Sarsa};

/// An update rule whose target is a reward and the discounted value of one next action.
pub trait BatchRule {
    /// Whether that action is A′, chosen before the update (on-policy). Otherwise it is the greedy one, and A′ is chosen
    /// after the update.
    const ON_POLICY: bool;
}

impl BatchRule for QLearning {
    const ON_POLICY: bool = false;
}

impl BatchRule for Sarsa {
    const ON_POLICY: bool = true;
}
