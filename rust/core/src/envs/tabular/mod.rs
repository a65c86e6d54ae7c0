//! Finite Markov decision processes: transition tables, and examples from Sutton & Barto.

mod initial_states;
mod interval_steps;
mod maximization_bias;
mod outcome;
mod outcome_distribution;
mod racetrack;
mod short_corridor;
mod tabular_mdp;
#[cfg(test)]
mod test_support;

pub use maximization_bias::{MaximizationBias, STATES as MAXIMIZATION_BIAS_STATES};
pub use outcome::{InvalidMdp, Outcome, TOLERANCE};
pub use racetrack::{Ground, Racetrack};
pub use short_corridor::ShortCorridor;
pub use tabular_mdp::TabularMdp;
