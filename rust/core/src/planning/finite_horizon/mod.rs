//! Policies under a time limit: a finite horizon (M. Puterman, *Markov Decision Processes*, 1994, chapter 4).

mod backward_induction;
mod policy_return;
mod stationary;

pub use backward_induction::{FiniteHorizon, PolicyChange, finite_horizon};
pub use policy_return::policy_return;
pub use stationary::{StationaryPolicy, stationary_policy};
