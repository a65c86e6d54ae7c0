//! The Q table: action values and their updates, for one active row or several.

mod linear;
mod moved_values;
mod row_sums;
mod table;
mod terminal_update;

pub(crate) use row_sums::{sum_rows, sum_values};
pub use table::QTable;
pub use terminal_update::TerminalUpdate;
