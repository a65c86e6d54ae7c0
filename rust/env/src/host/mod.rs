//! Calling an environment that another library exports.
//!
//! [`Environment::new`] checks the sizes and addresses of a [`Table`](crate::Table), an [`Episode`] owns the memory that
//! its functions read and write, and [`try_out`] plays some steps to find functions that break the rules of the
//! interface before a run relies on them.

mod buffer;
mod call_error;
mod environment;
mod episode;
mod random_bits;
mod step_time;
mod table_error;
mod trial;

pub use call_error::CallError;
pub use environment::Environment;
pub use episode::{Ending, Episode};
pub use random_bits::{BitGenerator, RandomBits};
pub use step_time::step_time;
pub use table_error::TableError;
pub use trial::{TrialError, try_out};
