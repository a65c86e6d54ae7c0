//! Why a checkpoint cannot be loaded into a run.

use std::error::Error;
use std::fmt;

use crate::checkpoint::CheckpointError;

/// Why a checkpoint cannot be loaded into a run. The run is unchanged, unless the error is `Damaged`.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LoadError {
    /// The bytes are not those of [`Trainer::save`](crate::Trainer::save).
    NotACheckpoint,
    /// A later version of this crate saved the checkpoint, in a format that this version does not know.
    LaterVersion {
        /// The version that saved it.
        version: String,
    },
    /// The checkpoint is that of another run.
    OtherRun {
        /// The part in which the runs differ, such as `seed`.
        part: String,
        /// That part of the saved run.
        saved: String,
        /// That part of this run.
        expected: String,
    },
    /// This run has already taken steps. A checkpoint is loaded into a new run.
    AlreadyStarted,
    /// The bytes are incomplete, or were changed.
    Damaged(CheckpointError),
}

impl fmt::Display for LoadError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotACheckpoint => formatter.write_str("these are not the bytes of a checkpoint"),
            Self::LaterVersion { version } => write!(
                formatter,
                "the checkpoint was saved by qtab-core {version}, in a format that {} does not know",
                env!("CARGO_PKG_VERSION")
            ),
            Self::OtherRun { part, saved, expected } => {
                write!(
                    formatter,
                    "the checkpoint is of another run: its {part} is {saved}, but this run's is {expected}"
                )
            }
            Self::AlreadyStarted => {
                formatter.write_str("this run has already taken steps; load a checkpoint into a new run")
            }
            Self::Damaged(error) => write!(formatter, "the checkpoint is damaged: {error}"),
        }
    }
}

impl Error for LoadError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        if let Self::Damaged(error) = self { Some(error) } else { None }
    }
}

impl From<CheckpointError> for LoadError {
    fn from(error: CheckpointError) -> Self {
        Self::Damaged(error)
    }
}
