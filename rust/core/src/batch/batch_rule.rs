//! The update rules that batches know.

use crate::learners::{ExpectedSarsa, QLearning, Sarsa};

/// An update rule whose target is a reward and the discounted value of the next state.
pub trait BatchRule {
    /// What that value is.
    const NEXT_VALUE: NextValue;
}

/// The value of the next state in a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NextValue {
    /// That of A′, which is chosen before the update. With the others it is chosen after the update.
    OfNextAction,
    /// The largest one.
    Largest,
    /// The expected value under the policy.
    Expected,
}

impl BatchRule for QLearning {
    const NEXT_VALUE: NextValue = NextValue::Largest;
}

impl BatchRule for Sarsa {
    const NEXT_VALUE: NextValue = NextValue::OfNextAction;
}

impl BatchRule for ExpectedSarsa {
    const NEXT_VALUE: NextValue = NextValue::Expected;
}
