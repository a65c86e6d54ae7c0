//! One entry of a transition table, and the check of its probabilities.

use super::InvalidMdp;

/// Probabilities may miss one by this much.
pub const TOLERANCE: f64 = 1e-9;

/// One entry of `P[state][action]`, as it is written there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// How likely it is.
    pub probability: f64,
    /// Where it leads.
    pub state: i64,
    /// What it brings.
    pub reward: f64,
    /// Whether the episode ends there.
    pub terminated: bool,
}

/// Looks whether these are probabilities.
pub(super) fn distribution(
    place: impl Fn() -> String,
    probabilities: impl Iterator<Item = f64>,
) -> Result<(), InvalidMdp> {
    let mut sum = 0.0;
    for (index, probability) in probabilities.enumerate() {
        if !(0.0..=1.0 + TOLERANCE).contains(&probability) {
            return Err(InvalidMdp(format!(
                "{}[{index}] must have a probability in [0, 1], got {probability}",
                place()
            )));
        }
        sum += probability;
    }
    if (sum - 1.0_f64).abs() > TOLERANCE {
        return Err(InvalidMdp(format!("{} must have probabilities that sum to 1, got {sum}", place())));
    }
    Ok(())
}
