//! The state of an unfinished run as bytes, so that the run can be resumed exactly where it stopped.

mod bytes;
mod episode_progress;
mod persist;
mod persist_types;
mod run_identity;
#[cfg(test)]
mod tests;

pub use bytes::{Checkpoint, CheckpointError};
pub use episode_progress::EpisodeProgress;
pub use persist::Persist;
pub use run_identity::RunIdentity;
