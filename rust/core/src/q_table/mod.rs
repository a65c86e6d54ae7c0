//! The Q table: action values and their updates, for one active row or several.

mod linear;
mod moved_values;
mod table;
mod terminal_update;

pub use table::QTable;
pub use terminal_update::TerminalUpdate;
