//! Why a call of an environment's function has no result.

use std::error::Error;
use std::fmt::{self, Display, Formatter};

/// A call without a result. The state of the episode is as before the call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CallError {
    /// The function returned `QTAB_FAILED`.
    Failed,
    /// The function returned a number that is not in `qtab_env.h`.
    Code {
        /// The name of the function.
        function: &'static str,
        /// The number.
        code: i32,
    },
    /// The reward is not a finite number.
    Reward(f64),
}

impl Display for CallError {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Failed => write!(formatter, "a function returned QTAB_FAILED"),
            Self::Code { function: "step", code } => {
                write!(
                    formatter,
                    "step must return a sum of QTAB_TERMINATED and QTAB_TRUNCATED, or QTAB_FAILED, got {code}"
                )
            }
            Self::Code { function, code } => {
                write!(formatter, "{function} must return QTAB_CONTINUES or QTAB_FAILED, got {code}")
            }
            Self::Reward(reward) => write!(formatter, "step must write a finite number as the reward, got {reward}"),
        }
    }
}

impl Error for CallError {}
