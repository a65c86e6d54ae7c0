//! One outcome of a transition table, and the check of its probabilities.

use std::error::Error;
use std::fmt;

/// The tolerance for sums of probabilities.
pub const TOLERANCE: f64 = 1e-9;

/// One outcome in `P[state][action]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The probability.
    pub probability: f64,
    /// The next state.
    pub state: i64,
    /// The reward.
    pub reward: f64,
    /// Whether the next state is terminal.
    pub terminated: bool,
}

/// The error for an invalid transition table: the reason and the location, in Python's notation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InvalidMdp(pub(in crate::envs) String);

impl fmt::Display for InvalidMdp {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl Error for InvalidMdp {}

/// Checks that these probabilities are a distribution. `location` names them in the error.
pub(super) fn check_distribution(
    location: impl Fn() -> String,
    probabilities: impl Iterator<Item = f64>,
) -> Result<(), InvalidMdp> {
    let mut sum = 0.0;
    for (index, probability) in probabilities.enumerate() {
        if !(0.0..=1.0 + TOLERANCE).contains(&probability) {
            return Err(InvalidMdp(format!(
                "{}[{index}] must have a probability in [0, 1], got {probability}",
                location()
            )));
        }
        sum += probability;
    }
    if (sum - 1.0_f64).abs() > TOLERANCE {
        return Err(InvalidMdp(format!("{} must have probabilities that sum to 1, got {sum}", location())));
    }
    Ok(())
}
