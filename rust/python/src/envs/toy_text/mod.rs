//! Gymnasium's toy text: transition tables, and Blackjack's rules. One environment per file.

mod blackjack;
mod sampling;
mod table;
mod taxi;
mod transition_table;

pub(super) use blackjack::BlackjackEnv;
pub(crate) use blackjack::PyBlackjack;
pub(crate) use table::PyToyText;
pub(super) use table::TableEnv;
pub(crate) use taxi::PyTaxi;
pub(super) use taxi::TaxiEnv;
pub(crate) use transition_table::PyTransitionTable;
pub(super) use transition_table::table_of;
