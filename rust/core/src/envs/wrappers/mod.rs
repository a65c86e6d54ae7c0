//! Environments around another environment.

mod blackjack_with_history;
mod discrete_actions;
mod with_transition_probability;

pub use blackjack_with_history::{BlackjackWithHistory, DealHistory};
pub use discrete_actions::DiscreteActions;
pub use with_transition_probability::{TransitionProbabilityState, WithTransitionProbability};
