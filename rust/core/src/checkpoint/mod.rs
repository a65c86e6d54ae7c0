//! The state of an unfinished run as bytes, so that the run can be resumed exactly where it stopped.

mod bytes;
mod persist;
#[cfg(test)]
mod tests;
mod trainer;

pub use bytes::{Checkpoint, CheckpointError};
pub use persist::{Persist, persist_rows};
pub use trainer::EpisodeProgress;
