//! Models of the environment and the methods that plan with them (Sutton & Barto, chapter 8).

mod dyna_model;
mod dyna_q;
mod dyna_q_plus;
mod model;
mod outcome_trees;
#[cfg(test)]
mod outcome_trees_tests;
mod planning;
mod predecessors;
mod prioritized_sweeping;
mod priority_queue;
mod stochastic_model;

pub use dyna_model::DynaModel;
pub use dyna_q::DynaQ;
pub use dyna_q_plus::DynaQPlus;
pub(super) use model::single_row;
pub use model::{Model, ModelEntry};
use planning::Planning;
use predecessors::Predecessors;
pub use prioritized_sweeping::PrioritizedSweeping;
use priority_queue::PriorityQueue;
pub use stochastic_model::StochasticModel;
