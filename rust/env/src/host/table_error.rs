//! Why a table is not an environment.

use std::error::Error;
use std::fmt::{self, Display, Formatter};

/// A table that is not that of an environment.
#[derive(Clone, Debug, PartialEq)]
pub enum TableError {
    /// The address is null.
    Null,
    /// The address is not that of a struct.
    Misaligned,
    /// The version of the interface, which is another.
    Version(u32),
    /// A field, the values that it may have, and its value.
    Field {
        /// The name of the field in `qtab_env.h`.
        name: &'static str,
        /// The values that are valid.
        expected: String,
        /// The value.
        got: String,
    },
}

impl Display for TableError {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Null => write!(formatter, "its table is NULL"),
            Self::Misaligned => write!(formatter, "its table is not aligned to 8 bytes"),
            Self::Version(version) => {
                write!(formatter, "its version of qtab_env.h must be {}, got {version}", crate::ENV_VERSION)
            }
            Self::Field { name, expected, got } => write!(formatter, "its {name} must be {expected}, got {got}"),
        }
    }
}

impl Error for TableError {}
