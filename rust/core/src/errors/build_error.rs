//! Why a run cannot be built.

use std::error::Error;
use std::fmt;

use crate::memory::AllocationError;

/// Why a run or its features cannot be built.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BuildError {
    /// A setting is invalid, or does not fit the others.
    Invalid {
        /// The name of the setting.
        setting: &'static str,
        /// What would be valid.
        expected: String,
        /// The value that was given.
        got: String,
    },
    /// The run does not fit into memory.
    Allocation(AllocationError),
}

impl BuildError {
    /// The error of a setting, with what would be valid and what was given.
    pub fn invalid(setting: &'static str, expected: impl fmt::Display, got: impl fmt::Display) -> Self {
        Self::Invalid { setting, expected: expected.to_string(), got: got.to_string() }
    }

    /// Refuses a setting that is not valid, with what would be and what was given.
    ///
    /// # Errors
    /// `Invalid` if `is_valid` is false.
    pub fn check(
        is_valid: bool,
        setting: &'static str,
        expected: impl fmt::Display,
        got: impl fmt::Display,
    ) -> Result<(), Self> {
        if is_valid { Ok(()) } else { Err(Self::invalid(setting, expected, got)) }
    }

    /// Refuses a number outside `[low, high]`, and NaN.
    ///
    /// # Errors
    /// `Invalid` for such a number.
    pub(crate) fn check_number(setting: &'static str, low: f64, high: f64, number: f64) -> Result<(), Self> {
        let is_valid = (low..=high).contains(&number);
        if high == f64::MAX {
            Self::check(is_valid, setting, format_args!("a finite number of at least {low}"), number)
        } else {
            Self::check(is_valid, setting, format_args!("a number in [{low}, {high}]"), number)
        }
    }
}

impl From<AllocationError> for BuildError {
    fn from(error: AllocationError) -> Self {
        Self::Allocation(error)
    }
}

impl fmt::Display for BuildError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Invalid { setting, expected, got } => write!(formatter, "{setting} must be {expected}, got {got}"),
            Self::Allocation(error) => write!(formatter, "the run does not fit into memory: {error}"),
        }
    }
}

impl Error for BuildError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        if let Self::Allocation(error) = self { Some(error) } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_names_the_setting_and_what_is_valid() {
        let message = |low, high, number| {
            let error = BuildError::check_number("discount", low, high, number).expect_err("it is outside");
            error.to_string()
        };
        assert_eq!(message(0.0, 1.0, 1.5), "discount must be a number in [0, 1], got 1.5");
        assert_eq!(message(0.0, f64::MAX, f64::NAN), "discount must be a finite number of at least 0, got NaN");
        assert_eq!(BuildError::check_number("discount", 0.0, 1.0, 1.0), Ok(()));
    }
}
