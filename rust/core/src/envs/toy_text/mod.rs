//! The environments of `gymnasium.envs.toy_text` that a transition table does not describe completely, and the tables
//! that Gymnasium builds slowly.

mod blackjack;
mod cliff_walking;
mod frozen_lake;
mod hand;
mod taxi;
mod taxi_table;

pub use blackjack::{Blackjack, BlackjackState, DEALER_STICKS, DECK};
pub use cliff_walking::cliff_walking;
pub use frozen_lake::{FrozenLake, LakeRewards, frozen_lake};
pub use hand::Hand;
pub use taxi::{Taxi, TaxiState};
pub use taxi_table::{TaxiMap, taxi_table};
