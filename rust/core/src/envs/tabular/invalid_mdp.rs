//! The error for an invalid transition table.

use std::error::Error;
use std::fmt;

/// Why a transition table is invalid, and where, in Python's notation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidMdp(pub(in crate::envs) String);

impl fmt::Display for InvalidMdp {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl Error for InvalidMdp {}
