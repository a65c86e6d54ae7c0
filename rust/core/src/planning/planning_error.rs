//! Why planning found no solution.

use std::error::Error;
use std::fmt;

use super::MAX_SWEEPS;

/// Why there is no solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanningError {
    /// The caller asked to stop.
    Stopped,
    /// The values still change after [`MAX_SWEEPS`].
    NotConverged,
    /// From this state no episode ends, and its rewards add up without a discount.
    NoProperPolicy(usize),
    /// From this state rewards can be collected for ever.
    UnboundedReturn(usize),
}

impl fmt::Display for PlanningError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stopped => write!(formatter, "it was stopped"),
            Self::NotConverged => write!(formatter, "the values still change after {MAX_SWEEPS} sweeps"),
            Self::NoProperPolicy(state) => write!(formatter, "from state {state} no episode ends"),
            Self::UnboundedReturn(state) => {
                write!(formatter, "from state {state} rewards can be collected without an end")
            }
        }
    }
}

impl Error for PlanningError {}
