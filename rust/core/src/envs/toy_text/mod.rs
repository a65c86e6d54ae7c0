//! The environments of `gymnasium.envs.toy_text` that a transition table does not describe completely.

mod blackjack;
mod hand;
mod taxi;

pub use blackjack::{Blackjack, BlackjackState, DEALER_STICKS, DECK};
pub use hand::Hand;
pub use taxi::{Taxi, TaxiState};
