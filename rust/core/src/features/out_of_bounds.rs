//! An observation outside the table.

use std::error::Error;
use std::fmt;

/// An observation that the features have no row for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfBounds {
    /// The index of the component of the observation.
    pub axis: usize,
    /// Its value.
    pub value: f64,
}

impl fmt::Display for OutOfBounds {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "observation[{}] is {}, outside the observation space", self.axis, self.value)
    }
}

impl Error for OutOfBounds {}
