//! Why a transition table is invalid.

use std::error::Error;
use std::fmt;

/// Why a table is none, and where; as Python spells it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidMdp(pub(super) String);

impl fmt::Display for InvalidMdp {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl Error for InvalidMdp {}
