//! What the learning algorithms share: the learner trait, the agent, eligibility traces, the model of Dyna.

mod action_masks;
mod agent;
mod aligned_vec;
mod average_reward;
mod count_bonus;
mod critic;
mod delegate_learner;
mod dyna_model;
mod eligible_weights;
mod episode_steps;
mod first_visits;
mod learner;
mod model;
mod n_step;
mod outcome_trees;
#[cfg(test)]
mod outcome_trees_tests;
mod policy_gradient;
mod policy_gradient_learner;
mod predecessors;
mod priority_queue;
mod step_in_parts;
mod stochastic_model;
mod target_policy;
mod td_learner;
#[cfg(test)]
pub(super) mod test_support;
mod trace_changes;
mod trace_decay;
mod trace_pass;
mod trace_removal;
mod traces;
#[cfg(test)]
mod traces_tests;
mod truncation_handling;
mod update_rule;

pub use action_masks::ActionMasks;
pub use agent::Agent;
pub(in crate::learners) use agent::available;
pub(in crate::learners) use agent::row_work;
pub(crate) use agent::{MAX_WORK_PER_CALL, VALUES_PER_WORK};
pub(in crate::learners) use average_reward::AverageReward;
pub use count_bonus::CountBonus;
pub use critic::Critic;
pub use dyna_model::DynaModel;
pub(in crate::learners) use episode_steps::EpisodeSteps;
pub(in crate::learners) use first_visits::{FirstVisits, step_of};
pub use learner::Learner;
pub(super) use model::single_row;
pub use model::{Model, ModelEntry};
pub use n_step::{NStep, NStepMethod, NStepVisit};
pub use policy_gradient_learner::{PolicyGradientLearner, PolicyGradientRule};
pub(in crate::learners) use predecessors::Predecessors;
pub(in crate::learners) use priority_queue::PriorityQueue;
pub(crate) use step_in_parts::StepInParts;
pub use stochastic_model::StochasticModel;
pub use target_policy::TargetPolicy;
pub use td_learner::TdLearner;
pub use traces::{TraceKind, Traces};
pub use truncation_handling::TruncationHandling;
pub use update_rule::UpdateRule;
