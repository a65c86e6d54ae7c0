//! What the learning algorithms share: the learner trait, the agent, eligibility traces, the model of Dyna.

mod action_masks;
mod agent;
mod critic;
mod eligible_weights;
mod learner;
mod model;
mod planning_progress;
mod policy_gradient;
mod policy_gradient_learner;
mod td_learner;
#[cfg(test)]
pub(super) mod test_support;
mod trace_passes;
mod traces;
#[cfg(test)]
mod traces_tests;
mod truncation_handling;
mod update_rule;

pub use action_masks::ActionMasks;
pub use agent::Agent;
pub(in crate::learners) use agent::available;
pub(crate) use agent::{MAX_WORK_PER_CALL, VALUES_PER_WORK};
pub use critic::Critic;
pub use learner::Learner;
pub(super) use model::single_row;
pub use model::{Model, ModelEntry};
pub(in crate::learners) use planning_progress::PlanningProgress;
pub use policy_gradient_learner::{PolicyGradientLearner, PolicyGradientRule};
pub use td_learner::TdLearner;
pub use traces::{TraceKind, Traces};
pub use truncation_handling::TruncationHandling;
pub use update_rule::UpdateRule;
