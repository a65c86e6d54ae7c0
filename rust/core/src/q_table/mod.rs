//! The Q table: action values per row, sums over active rows, and updates.

mod linear;
mod table;
mod terminal_update;

pub use table::QTable;
pub use terminal_update::TerminalUpdate;
