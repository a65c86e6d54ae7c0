//! Planning errors.

use std::error::Error;
use std::fmt;

use crate::memory::AllocationError;

/// The number of sweeps after which values that still change count as growing without bound.
pub const MAX_SWEEPS: u64 = 200_000;

/// The reason why planning found no solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanningError {
    /// The caller set the stop flag.
    Stopped,
    /// The solution does not fit into memory: this many more bytes could not be allocated.
    OutOfMemory {
        /// The number of bytes.
        bytes: usize,
    },
    /// The values still change after this many sweeps: [`MAX_SWEEPS`], or fewer if their equations are singular to
    /// rounding.
    NotConverged {
        /// The number of sweeps.
        sweeps: u64,
    },
    /// No policy is proper: from this state no episode ends, and undiscounted rewards add up without bound.
    NoProperPolicy(usize),
    /// From this state, a policy collects an unbounded return.
    UnboundedReturn(usize),
    /// The value of this state exceeds the range of f64.
    Overflow(usize),
}

impl fmt::Display for PlanningError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stopped => write!(formatter, "planning was stopped"),
            Self::OutOfMemory { bytes } => write!(formatter, "{bytes} more bytes could not be allocated"),
            Self::NotConverged { sweeps } => write!(formatter, "the values still change after {sweeps} sweeps"),
            Self::NoProperPolicy(state) => write!(formatter, "from state {state} no episode ends"),
            Self::UnboundedReturn(state) => write!(formatter, "from state {state} the return is unbounded"),
            Self::Overflow(state) => write!(formatter, "the return from state {state} exceeds the range of float64"),
        }
    }
}

impl Error for PlanningError {}

impl From<AllocationError> for PlanningError {
    fn from(error: AllocationError) -> Self {
        match error {
            AllocationError::OutOfMemory { bytes } => Self::OutOfMemory { bytes },
            AllocationError::Stopped => Self::Stopped,
            // Planning has no memory limit, and the entries that it numbers fit into memory.
            AllocationError::LimitReached { .. } | AllocationError::TooManyEntries => {
                Self::OutOfMemory { bytes: usize::MAX }
            }
        }
    }
}
