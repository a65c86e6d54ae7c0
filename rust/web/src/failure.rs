//! Why a request is rejected, or a run cannot continue.

use qtab_core::features::OutOfBounds;
use qtab_core::memory::AllocationError;
use serde::Serialize;

/// The reason why a request is rejected or a run cannot continue, and the name of the setting if it is one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Failure {
    pub(crate) setting: Option<String>,
    #[serde(rename = "error")]
    pub(crate) message: String,
}

impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self { setting: None, message }
    }
}

impl From<&str> for Failure {
    fn from(message: &str) -> Self {
        message.to_string().into()
    }
}

impl From<OutOfBounds> for Failure {
    fn from(error: OutOfBounds) -> Self {
        error.to_string().into()
    }
}

impl From<AllocationError> for Failure {
    fn from(error: AllocationError) -> Self {
        format!("the run does not fit into memory: {error}").into()
    }
}
