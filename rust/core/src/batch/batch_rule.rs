//! The update rules that batches support.

use crate::learners::{ExpectedSarsa, QLearning, Sarsa};

/// An update rule whose target is a reward and the discounted value of the next state.
pub trait BatchRule {
    /// The kind of that value.
    const NEXT_VALUE: NextValue;
}

/// The value of the next state in a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NextValue {
    /// Q(S′, A′). A′ is chosen before the update; for the other kinds, the next action is chosen after it.
    OfNextAction,
    /// maxₐ Q(S′, a).
    Largest,
    /// Σₐ π(a | S′) Q(S′, a).
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
