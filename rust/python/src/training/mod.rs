//! What Python calls to train: one run that it can advance, or many runs at once.

mod env_spec;
mod many;
mod memory;
mod results;
mod testbed;
mod trainer;

pub(crate) use env_spec::EnvironmentSpec;
pub(crate) use many::train_many;
pub(crate) use memory::{Memory, room_of};
pub(crate) use testbed::run_testbeds;
pub(crate) use trainer::PyTrainer;

/// Signals are checked after this much work: some 8192 steps of Q-learning on a grid, a fraction of a millisecond.
pub(crate) const WORK_BETWEEN_CHECKS: u64 = 8192;
