//! Monte Carlo control, which learns when an episode ends (Sutton & Barto, chapter 5).

mod episode_steps;
mod monte_carlo_control;
mod off_policy_monte_carlo;

use episode_steps::EpisodeSteps;
pub use monte_carlo_control::MonteCarloControl;
pub use off_policy_monte_carlo::OffPolicyMonteCarlo;
