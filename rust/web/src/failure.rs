//! Why a run cannot be made or continued.

use qtab_core::features::OutOfBounds;
use qtab_core::memory::AllocationError;

/// The reason why a run cannot be made or continued.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Failure(pub(crate) String);

impl From<OutOfBounds> for Failure {
    fn from(error: OutOfBounds) -> Self {
        Self(error.to_string())
    }
}

impl From<AllocationError> for Failure {
    fn from(error: AllocationError) -> Self {
        Self(format!("the run does not fit into memory: {error}"))
    }
}
