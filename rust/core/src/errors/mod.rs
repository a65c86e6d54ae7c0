//! The errors of this crate that more than one subject returns.

mod build_error;
mod training_error;

pub use build_error::BuildError;
pub use training_error::TrainingError;
