//! The shared parts of all learners: their traits, the agent, and wrappers.

mod action_masks;
mod agent;
mod count_bonus;
mod delegate_learner;
mod learner;
mod step_in_parts;
mod td_learner;
#[cfg(test)]
pub(super) mod test_support;
mod transformed_steps;
mod update_rule;

pub use action_masks::ActionMasks;
pub use agent::Agent;
pub(super) use agent::{MAX_WORK_PER_CALL, VALUES_PER_WORK, masked_values, row_work};
pub use count_bonus::CountBonus;
pub use learner::Learner;
pub(crate) use step_in_parts::StepInParts;
pub use td_learner::TdLearner;
pub use transformed_steps::TransformedSteps;
pub use update_rule::UpdateRule;
pub(super) use update_rule::learn_borrowed;
