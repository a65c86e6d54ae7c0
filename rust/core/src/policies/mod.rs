//! Policies choose an action by its value.

mod any_policy;
mod epsilon_greedy;
mod greedy_policy;
mod policy;
mod softmax;
mod tie_breaking;
mod ucb;

pub use any_policy::AnyPolicy;
pub(crate) use any_policy::random_available_action;
pub use epsilon_greedy::EpsilonGreedy;
pub use greedy_policy::GreedyPolicy;
pub use policy::Policy;
pub(crate) use policy::assert_takes;
pub use softmax::Softmax;
pub use tie_breaking::TieBreaking;
pub use ucb::Ucb;
