//! Gymnasium's toy text: transition tables, and Blackjack's rules. One environment per file.

mod blackjack;
mod sampling;
mod table;
mod taxi;
mod transition_table;

pub(crate) use blackjack::PyBlackjack;
pub(super) use blackjack::blackjack_env;
pub(crate) use table::PyToyText;
pub(super) use table::table_env;
pub(crate) use taxi::PyTaxi;
pub(super) use taxi::taxi_env;
pub(crate) use transition_table::PyTransitionTable;
pub(super) use transition_table::table_of;
