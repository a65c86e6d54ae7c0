//! Those of Gymnasium's toy text environments that a transition table alone does not describe.

mod blackjack;
mod hand;
mod taxi;

pub use blackjack::{Blackjack, BlackjackState, DEALER_STICKS, DECK};
pub use hand::Hand;
pub use taxi::{Taxi, TaxiState};
