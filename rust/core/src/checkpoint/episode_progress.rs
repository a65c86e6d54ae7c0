//! The progress within an episode at a checkpoint.

use super::{Checkpoint, CheckpointError, Persist};

/// Whether a checkpoint was made between two episodes or within one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EpisodeProgress {
    /// Between two episodes.
    Between,
    /// Within an episode, which is resumed.
    Within,
    /// Within an episode that is abandoned, because the task cannot restore its state, or because it failed. The run
    /// resumes with the next episode, and differs from an uninterrupted one from then on.
    Abandoned,
}

impl Persist for EpisodeProgress {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let mut number = *self as u8;
        number.persist(checkpoint)?;
        *self = match number {
            0 => Self::Between,
            1 => Self::Within,
            2 => Self::Abandoned,
            _ => return Err(CheckpointError::Invalid("progress of an episode")),
        };
        Ok(())
    }
}
