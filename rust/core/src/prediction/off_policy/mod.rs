//! Off-policy methods: the values of a target policy from episodes of a behavior policy (Sutton & Barto, chapters 5 and 11).

mod emphatic_td;
mod feature_counts;
mod gradient_td;
mod importance_sampling;
mod off_policy_td;

pub use emphatic_td::EmphaticTd;
pub use gradient_td::{GradientTd, GradientTdKind};
pub use importance_sampling::ImportanceSampling;
pub use off_policy_td::OffPolicyTd;
