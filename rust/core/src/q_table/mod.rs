//! The Q table: action values and their updates, for one or more active rows.

mod linear;
mod moved_values;
mod table;
mod weighted;

pub use linear::TerminalUpdate;
pub(crate) use linear::sum_rows;
pub use table::QTable;
pub(crate) use weighted::add_to_column;
